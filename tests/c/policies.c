/* Policies through the C interface, and the refusal of every wrong call.
 *
 *   policies policies/mission/policy.safetensors
 *
 * The program prints the hash of the last state of each mission. The first missions are the
 * network's: deterministic and sampled. The missions of all baselines follow. */
#include "check.h"

#include <inttypes.h>

enum { UAVS = 10, HOTSPOTS = 3, ACTIONS = 2 * UAVS, MEMBERS = 3, SEED = 4 };

static uint64_t not_a_handle[4096];
#define FOREIGN(type) ((type *)(void *)not_a_handle)

static unsigned char *file;
static size_t length;

static void read_file(const char *path)
{
    FILE *stream = fopen(path, "rb");
    CHECK(stream != NULL);
    file = ARRAY(unsigned char, 1 << 20);
    length = fread(file, 1, 1 << 20, stream);
    CHECK(length > 1000 && length < 1 << 20);
    fclose(stream);
}

static jcas_model *build(uint32_t uavs, int32_t visibility)
{
    jcas_config config;
    jcas_model *model;
    OK(jcas_config_default(&config, sizeof config));
    config.uav_count = uavs;
    config.hotspot_count = HOTSPOTS;
    config.target_visibility = visibility;
    OK(jcas_model_new(&config, &model, NULL, 0));
    return model;
}

static uint64_t fly(jcas_policy *policy, jcas_sim *sim, uint64_t seed)
{
    float actions[ACTIONS];
    uint64_t hash;
    jcas_outcome outcome;
    memset(&outcome, 0, sizeof outcome);
    outcome.struct_size = sizeof outcome;
    OK(jcas_sim_reset(sim, seed));
    while (!outcome.terminated && !outcome.truncated) {
        OK(jcas_policy_act(policy, sim, actions, ACTIONS));
        OK(jcas_sim_step(sim, actions, ACTIONS, &outcome));
    }
    OK(jcas_sim_hash(sim, &hash));
    return hash;
}

static void abuse_files(const jcas_model *model)
{
    jcas_policy *policy = FOREIGN(jcas_policy);
    char why[128] = "";
    size_t size = 7, alignment = 7;
    for (size_t end = 0; end < length; end += 1 + end / 7) {
        EXPECT(JCAS_ERROR_CORRUPT, jcas_policy_load(model, file, end, &policy, why, sizeof why));
        CHECK(why[0] != 0);
        EXPECT(JCAS_ERROR_CORRUPT,
               jcas_policy_layout(model, file, end, &size, &alignment, NULL, 0));
    }
    unsigned char *damaged = ARRAY(unsigned char, length);
    memcpy(damaged, file, length);
    damaged[length - 1] = 0x7e; /* the last weight, half precision: not a number */
    damaged[length - 2] = 0x01;
    why[0] = 0;
    EXPECT(JCAS_ERROR_CORRUPT, jcas_policy_load(model, damaged, length, &policy, why, sizeof why));
    CHECK(strstr(why, "finite") != NULL);
    EXPECT(JCAS_ERROR_CORRUPT,
           jcas_policy_layout(model, damaged, length, &size, &alignment, NULL, 0));
    free(damaged);
    EXPECT(JCAS_ERROR_NULL, jcas_policy_load(NULL, file, length, &policy, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_load(model, NULL, length, &policy, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_load(model, file, length, NULL, NULL, 0));
    EXPECT(JCAS_ERROR_HANDLE,
           jcas_policy_load(FOREIGN(jcas_model), file, length, &policy, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_layout(model, file, length, NULL, &alignment, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_layout(model, file, length, &size, NULL, NULL, 0));
    CHECK(policy == FOREIGN(jcas_policy) && size == 7 && alignment == 7);
}

static void abuse_names(const jcas_model *model)
{
    jcas_policy *policy = FOREIGN(jcas_policy);
    char why[160] = "";
    EXPECT(JCAS_ERROR_ARGUMENT,
           jcas_policy_baseline(model, "swan", NULL, &policy, why, sizeof why));
    CHECK(strstr(why, "greedy") != NULL && strstr(why, "replan") != NULL);
    EXPECT(JCAS_ERROR_ARGUMENT,
           jcas_policy_baseline(model, "tems", NULL, &policy, why, sizeof why));
    CHECK(strstr(why, "did you mean teams?") != NULL);
    CHECK(strcmp(jcas_policy_name(3), "teams") == 0 && strcmp(jcas_policy_name(8), "replan") == 0);
    CHECK(strstr(jcas_policy_summary(3), "quorum") != NULL);
    CHECK(jcas_policy_name(9) == NULL && jcas_policy_summary(9) == NULL);
    EXPECT(JCAS_ERROR_ARGUMENT,
           jcas_policy_baseline(model, "greedy", "2", &policy, why, sizeof why));
    CHECK(strstr(why, "pilot") != NULL);
    EXPECT(JCAS_ERROR_NULL, jcas_policy_baseline(model, NULL, NULL, &policy, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_baseline(model, "greedy", NULL, NULL, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_baseline(NULL, "greedy", NULL, &policy, NULL, 0));
    jcas_model *hidden = build(UAVS, JCAS_VISIBILITY_HIDDEN);
    EXPECT(JCAS_ERROR_ARGUMENT,
           jcas_policy_baseline(hidden, "greedy", NULL, &policy, why, sizeof why));
    CHECK(policy == FOREIGN(jcas_policy) && strstr(why, "target_visibility") != NULL);
    OK(jcas_model_free(hidden));
}

static void abuse_acting(jcas_model *model, jcas_sim *sim, jcas_batch *batch)
{
    jcas_policy *policy;
    float actions[MEMBERS * ACTIONS];
    OK(jcas_policy_load(model, file, length, &policy, NULL, 0));
    EXPECT(JCAS_ERROR_IN_USE, jcas_model_free(model));
    mark(actions, sizeof actions);
    EXPECT(JCAS_ERROR_NULL, jcas_policy_act(NULL, sim, actions, ACTIONS));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_act(policy, NULL, actions, ACTIONS));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_act(policy, sim, NULL, ACTIONS));
    EXPECT(JCAS_ERROR_LENGTH, jcas_policy_act(policy, sim, actions, ACTIONS - 1));
    EXPECT(JCAS_ERROR_HANDLE, jcas_policy_act(FOREIGN(jcas_policy), sim, actions, ACTIONS));
    EXPECT(JCAS_ERROR_HANDLE, jcas_policy_act(policy, FOREIGN(jcas_sim), actions, ACTIONS));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_act_batch(NULL, batch, actions, MEMBERS * ACTIONS));
    EXPECT(JCAS_ERROR_LENGTH, jcas_policy_act_batch(policy, batch, actions, ACTIONS));
    EXPECT(JCAS_ERROR_HANDLE,
           jcas_policy_act_batch(policy, FOREIGN(jcas_batch), actions, MEMBERS * ACTIONS));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_policy_set_mode(policy, 3));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_set_mode(NULL, JCAS_POLICY_SAMPLED));

    /* This simulation has another configuration. */
    jcas_model *other = build(UAVS - 1, JCAS_VISIBILITY_KNOWN);
    jcas_sim *foreign;
    OK(jcas_sim_new(other, &foreign));
    EXPECT(JCAS_ERROR_MODEL_MISMATCH, jcas_policy_act(policy, foreign, actions, ACTIONS - 2));
    CHECK(untouched(actions, sizeof actions));
    OK(jcas_sim_free(foreign));
    OK(jcas_model_free(other));

    OK(jcas_policy_free(policy));
    OK(jcas_policy_free(NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_policy_free(FOREIGN(jcas_policy)));
}

/* The actions are the same from the caller's memory and for every member of a batch. */
static void same_everywhere(jcas_sim *sim, jcas_batch *batch, jcas_policy *policy,
                            jcas_policy *lent)
{
    float one[ACTIONS], other[ACTIONS], all[MEMBERS * ACTIONS];
    OK(jcas_policy_act_batch(policy, batch, all, MEMBERS * ACTIONS));
    for (uint32_t member = 0; member < MEMBERS; member++) {
        OK(jcas_batch_get(batch, member, sim));
        OK(jcas_policy_act(policy, sim, one, ACTIONS));
        CHECK(memcmp(one, all + member * ACTIONS, sizeof one) == 0);
        if (lent != NULL) {
            OK(jcas_policy_act(lent, sim, other, ACTIONS));
            CHECK(memcmp(one, other, sizeof one) == 0);
        }
    }
}

/* Steps with the policy and returns the hash of the state. */
static uint64_t go_on(jcas_policy *policy, jcas_sim *sim, int steps)
{
    jcas_outcome outcome = {.struct_size = sizeof outcome};
    float actions[ACTIONS];
    uint64_t hash;
    while (steps-- > 0) {
        OK(jcas_policy_act(policy, sim, actions, ACTIONS));
        OK(jcas_sim_step(sim, actions, ACTIONS, &outcome));
    }
    OK(jcas_sim_hash(sim, &hash));
    return hash;
}

static void *saved_memory(jcas_policy *policy, const jcas_sim *sim, size_t *size)
{
    size_t again;
    OK(jcas_policy_memory_save(policy, sim, NULL, 0, size));
    unsigned char *memory = ARRAY(unsigned char, *size);
    EXPECT(JCAS_ERROR_LENGTH, jcas_policy_memory_save(policy, sim, memory, *size - 1, &again));
    OK(jcas_policy_memory_save(policy, sim, memory, *size, &again));
    CHECK(again == *size);
    return memory;
}

/* A state and what the policy remembers in it give the same future. That holds in another
 * simulation and policy, in the same ones, and in a batch. Without its memory the state is
 * refused. */
static void remember(jcas_model *model, const char *name, size_t snapshot_size)
{
    float actions[MEMBERS * ACTIONS];
    jcas_batch *batch;
    jcas_sim *sim, *fork;
    jcas_policy *policy, *other;
    size_t size, member_size;
    int remembers = strcmp(name, "random") && strcmp(name, "untrained") && strcmp(name, "greedy") &&
                    strcmp(name, "plan");
    int32_t status = remembers ? JCAS_ERROR_MEMORY : JCAS_OK;
    OK(jcas_policy_baseline(model, name, "max", &policy, NULL, 0));
    OK(jcas_policy_baseline(model, name, "max", &other, NULL, 0));
    OK(jcas_sim_new(model, &sim));
    OK(jcas_sim_new(model, &fork));
    OK(jcas_batch_new(model, MEMBERS, 1, &batch));
    OK(jcas_sim_reset(sim, SEED));
    go_on(policy, sim, 3);
    void *snapshot = allocated(snapshot_size);
    OK(jcas_sim_save(sim, snapshot, snapshot_size));
    unsigned char *memory = saved_memory(policy, sim, &size);
    uint64_t hash = go_on(policy, sim, 3);
    OK(jcas_sim_load(sim, snapshot, snapshot_size));
    EXPECT(status, jcas_policy_act(policy, sim, actions, ACTIONS));
    EXPECT(status, jcas_policy_memory_save(policy, sim, NULL, 0, &member_size));
    OK(jcas_policy_memory_load(policy, sim, memory, size));
    CHECK(go_on(policy, sim, 3) == hash);
    EXPECT(JCAS_ERROR_MEMORY, jcas_policy_memory_load(policy, sim, memory, size));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_memory_load(policy, sim, NULL, size));

    /* A fork has a policy of its own. */
    OK(jcas_sim_load(sim, snapshot, snapshot_size));
    OK(jcas_policy_memory_load(policy, sim, memory, size));
    OK(jcas_sim_fork(sim, fork));
    OK(jcas_policy_memory_load(other, fork, memory, size));
    CHECK(go_on(other, fork, 3) == hash && go_on(policy, sim, 3) == hash);
    EXPECT(status, jcas_policy_act(policy, fork, actions, ACTIONS));

    /* So has an environment of a batch. */
    OK(jcas_sim_load(sim, snapshot, snapshot_size));
    OK(jcas_batch_set(batch, 1, sim));
    OK(jcas_policy_memory_load_member(other, batch, 1, memory, size));
    OK(jcas_policy_memory_save_member(other, batch, 1, NULL, 0, &member_size));
    CHECK(member_size == size);
    EXPECT(JCAS_ERROR_ARGUMENT,
           jcas_policy_memory_load_member(other, batch, MEMBERS, memory, size));
    OK(jcas_policy_act_batch(other, batch, actions, MEMBERS * ACTIONS));
    float one[ACTIONS];
    OK(jcas_policy_memory_load(policy, sim, memory, size));
    OK(jcas_policy_act(policy, sim, one, ACTIONS));
    CHECK(memcmp(one, actions + ACTIONS, sizeof one) == 0);
    OK(jcas_batch_set(batch, 1, sim));
    EXPECT(status, jcas_policy_act_batch(other, batch, actions, MEMBERS * ACTIONS));
    OK(jcas_policy_forget(other));
    OK(jcas_policy_act_batch(other, batch, actions, MEMBERS * ACTIONS));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_forget(NULL));

    /* Bytes that were changed or cut are refused. */
    for (size_t at = 0; at < size; at += 5) {
        memory[at] ^= 1;
        EXPECT(JCAS_ERROR_CORRUPT, jcas_policy_memory_load(policy, sim, memory, size));
        memory[at] ^= 1;
    }
    EXPECT(JCAS_ERROR_CORRUPT, jcas_policy_memory_load(policy, sim, memory, size - 8));
    OK(jcas_policy_free(other));
    OK(jcas_policy_baseline(model, "squads", "min", &other, NULL, 0));
    EXPECT(JCAS_ERROR_MEMORY, jcas_policy_memory_load(other, sim, memory, size));
    free(memory);
    free(snapshot);
    OK(jcas_policy_free(other));
    OK(jcas_policy_free(policy));
    OK(jcas_batch_free(batch));
    OK(jcas_sim_free(fork));
    OK(jcas_sim_free(sim));
}

int main(int argc, char **argv)
{
    static const char *const NAMES[] = {"random", "untrained", "greedy", "teams",
                                        "squads", "line",      "answer"};
    static const uint64_t SEEDS[MEMBERS] = {11, 12, 13};
    CHECK(argc == 2);
    read_file(argv[1]);
    jcas_model *model = build(UAVS, JCAS_VISIBILITY_KNOWN);
    jcas_model_info info;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    OK(jcas_model_get_info(model, &info));
    jcas_sim *sim;
    jcas_batch *batch;
    OK(jcas_sim_new(model, &sim));
    OK(jcas_batch_new(model, MEMBERS, 1, &batch));
    size_t observed = (size_t)MEMBERS * info.uav_count * info.observation_len;
    float *observations = ARRAY(float, observed);
    OK(jcas_batch_reset(batch, SEEDS, MEMBERS, observations, observed, NULL, 0));
    free(observations);
    abuse_files(model);
    abuse_names(model);
    abuse_acting(model, sim, batch);

    size_t size, alignment;
    jcas_policy *policy, *lent;
    OK(jcas_policy_layout(model, file, length, &size, &alignment, NULL, 0));
    CHECK(alignment <= 16);
    void *memory = allocated(size);
    memset(memory, 0, size);
    EXPECT(JCAS_ERROR_LENGTH,
           jcas_policy_init(memory, size - 1, model, file, length, &lent, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_init(NULL, size, model, file, length, &lent, NULL, 0));
    OK(jcas_policy_init(memory, size, model, file, length, &lent, NULL, 0));
    /* A policy in use is not overwritten. */
    jcas_policy *over = FOREIGN(jcas_policy);
    jcas_sim *sim_over = FOREIGN(jcas_sim);
    EXPECT(JCAS_ERROR_IN_USE, jcas_policy_init(memory, size, model, file, length, &over, NULL, 0));
    EXPECT(JCAS_ERROR_IN_USE, jcas_sim_init(memory, size, model, &sim_over));
    CHECK(over == FOREIGN(jcas_policy) && sim_over == FOREIGN(jcas_sim));
    OK(jcas_policy_load(model, file, length, &policy, NULL, 0));
    same_everywhere(sim, batch, policy, lent);
    OK(jcas_policy_free(lent));
    free(memory);
    printf("0x%016" PRIx64 "\n", fly(policy, sim, SEED));
    OK(jcas_policy_set_mode(policy, JCAS_POLICY_SAMPLED));
    same_everywhere(sim, batch, policy, NULL);
    printf("0x%016" PRIx64 "\n", fly(policy, sim, SEED));
    OK(jcas_policy_free(policy));

    for (size_t k = 0; k < sizeof NAMES / sizeof *NAMES; k++) {
        OK(jcas_policy_baseline(model, NAMES[k], "max", &policy, NULL, 0));
        same_everywhere(sim, batch, policy, NULL);
        /* Each policy runs twice, so that memory of one mission cannot affect the next. */
        CHECK(fly(policy, sim, SEED + 1) != 0);
        printf("0x%016" PRIx64 "\n", fly(policy, sim, SEED));
        OK(jcas_policy_free(policy));
        remember(model, NAMES[k], info.snapshot_size);
    }
    remember(model, "replan", info.snapshot_size);
    free(file);
    OK(jcas_batch_free(batch));
    OK(jcas_sim_free(sim));
    OK(jcas_model_free(model));
    return 0;
}
