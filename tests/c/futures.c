/* Forks and rollouts: every environment of a batch makes what a simulation alone makes, bit for
 * bit, for every policy and number of threads. Wrong calls are refused by name.
 *
 *   futures policies/mission/policy.safetensors
 */
#include "check.h"

enum { UAVS = 5, HOTSPOTS = 2, ACTIONS = 2 * UAVS, M = 5, HORIZON = 24, K = 16, LEAD = 3 };

static uint64_t not_a_handle[4096];
#define FOREIGN(type) ((type *)(void *)not_a_handle)

static unsigned char *file;
static size_t length, snapshot_size;
static jcas_model *model;
static const uint64_t SEEDS[M] = {4, 90, 7, 1, 123456789};

/* What a rollout gives, from one call or step by step. */
struct futures {
    double returns[M];
    uint32_t steps[M];
    uint8_t terminated[M], truncated[M];
    jcas_metrics metrics[M];
    float actions[M * K * ACTIONS];
    unsigned char *snapshots;
};

static struct futures expected, got;

static jcas_rollout_out buffers(struct futures *futures)
{
    jcas_rollout_out out = {.struct_size = sizeof out};
    out.returns = futures->returns, out.return_count = M;
    out.steps = futures->steps, out.step_count = M;
    out.terminated = futures->terminated, out.terminated_count = M;
    out.truncated = futures->truncated, out.truncated_count = M;
    out.metrics = futures->metrics, out.metrics_count = M;
    out.metrics_size = sizeof(jcas_metrics);
    out.snapshots = futures->snapshots, out.snapshots_size = M * snapshot_size;
    return out;
}

/* The name of a baseline, or NULL and the file of a network. */
static jcas_policy *policy_of(const char *name, int32_t mode)
{
    jcas_policy *policy;
    if (name != NULL) {
        OK(jcas_policy_baseline(model, name, "max", &policy, NULL, 0));
    } else {
        OK(jcas_policy_load(model, file, length, &policy, NULL, 0));
        OK(jcas_policy_set_mode(policy, mode));
    }
    return policy;
}

static void lead(jcas_policy *policy, jcas_sim *sim)
{
    jcas_outcome outcome = {.struct_size = sizeof outcome};
    float actions[ACTIONS];
    OK(jcas_sim_reset(sim, SEEDS[0]));
    for (int step = 0; step < LEAD; step++) {
        OK(jcas_policy_act(policy, sim, actions, ACTIONS));
        OK(jcas_sim_step(sim, actions, ACTIONS, &outcome));
    }
}

/* Flies one member of a forked batch alone, in a simulation and with a policy of its own. */
static void alone(jcas_policy *policy, jcas_batch *batch, uint32_t m, jcas_policy *other)
{
    size_t size;
    jcas_sim *sim;
    jcas_outcome outcome = {.struct_size = sizeof outcome};
    OK(jcas_sim_new(model, &sim));
    OK(jcas_batch_get(batch, m, sim));
    OK(jcas_policy_memory_save_member(policy, batch, m, NULL, 0, &size));
    unsigned char *memory = ARRAY(unsigned char, size);
    OK(jcas_policy_memory_save_member(policy, batch, m, memory, size, &size));
    OK(jcas_policy_memory_load(other, sim, memory, size));
    free(memory);
    float *actions = expected.actions + (size_t)m * K * ACTIONS;
    memset(actions, 0, K * ACTIONS * sizeof *actions);
    expected.returns[m] = 0;
    expected.steps[m] = 0;
    for (int k = 0; k < K && !outcome.terminated && !outcome.truncated; k++) {
        OK(jcas_policy_act(other, sim, actions + k * ACTIONS, ACTIONS));
        OK(jcas_sim_step(sim, actions + k * ACTIONS, ACTIONS, &outcome));
        expected.returns[m] += outcome.reward;
        expected.steps[m]++;
    }
    expected.terminated[m] = (uint8_t)outcome.terminated;
    expected.truncated[m] = (uint8_t)outcome.truncated;
    expected.metrics[m].struct_size = sizeof(jcas_metrics);
    OK(jcas_sim_get_metrics(sim, &expected.metrics[m]));
    OK(jcas_sim_save(sim, expected.snapshots + m * snapshot_size, snapshot_size));
    OK(jcas_sim_free(sim));
}

static void same_futures(void)
{
    CHECK(memcmp(expected.returns, got.returns, sizeof got.returns) == 0);
    CHECK(memcmp(expected.steps, got.steps, sizeof got.steps) == 0);
    CHECK(memcmp(expected.terminated, got.terminated, sizeof got.terminated) == 0);
    CHECK(memcmp(expected.truncated, got.truncated, sizeof got.truncated) == 0);
    CHECK(memcmp(expected.metrics, got.metrics, sizeof got.metrics) == 0);
    CHECK(memcmp(expected.snapshots, got.snapshots, M * snapshot_size) == 0);
}

/* A second rollout ends the episodes at the horizon, and a third one makes no step. */
static void to_the_end(jcas_policy *policy, jcas_batch *batch)
{
    jcas_rollout_out out = buffers(&got);
    OK(jcas_batch_rollout(batch, policy, NULL, 0, K, &out));
    for (uint32_t m = 0; m < M; m++) {
        CHECK(got.terminated[m] + got.truncated[m] == 1);
        CHECK(got.metrics[m].steps == (got.terminated[m] ? got.metrics[m].steps : HORIZON));
    }
    OK(jcas_batch_rollout(batch, policy, NULL, 0, K, &out));
    for (uint32_t m = 0; m < M; m++)
        CHECK(got.steps[m] == 0 && got.returns[m] == 0 && got.terminated[m] + got.truncated[m]);
}

/* Two rollouts of half the steps are one: what the policy remembers goes on. */
static void in_halves(jcas_policy *policy, jcas_batch *batch)
{
    jcas_rollout_out out = {.struct_size = sizeof out, .returns = got.returns, .return_count = M};
    OK(jcas_batch_rollout(batch, policy, NULL, 0, K / 2, &out));
    OK(jcas_batch_rollout(batch, policy, NULL, 0, K / 2, &out));
    OK(jcas_batch_save(batch, got.snapshots, M * snapshot_size));
    CHECK(memcmp(expected.snapshots, got.snapshots, M * snapshot_size) == 0);
}

/* Runs the tasks backwards on this thread, one of them again and again. */
static void run_backwards(jcas_task task, void *task_context, uint32_t count, void *context)
{
    CHECK(context == NULL);
    for (uint32_t i = count; i-- > 0;) {
        task(task_context, i);
        task(task_context, count - 1);
    }
}

static jcas_batch *batch_of(uint32_t threads, jcas_run_tasks run, void **memory)
{
    jcas_batch *batch;
    size_t size, alignment;
    jcas_batch_options options = {
        .struct_size = sizeof options, .environments = M, .threads = threads, .run = run};
    OK(jcas_batch_layout(model, &options, &size, &alignment));
    *memory = allocated(size);
    memset(*memory, 0, size);
    OK(jcas_batch_init(*memory, size, model, &options, &batch));
    return batch;
}

static void fly(const char *name, int32_t mode, const uint64_t *seeds)
{
    size_t seed_count = seeds == NULL ? 0 : M;
    jcas_policy *policy = policy_of(name, mode), *other = policy_of(name, mode);
    jcas_sim *sim, *member;
    OK(jcas_sim_new(model, &sim));
    OK(jcas_sim_new(model, &member));
    lead(policy, sim);
    /* Annealing takes long, so policies that plan fly once. */
    uint32_t first = name != NULL && strstr(name, "plan") != NULL ? 4 : 1;
    for (uint32_t threads = first; threads < 5; threads++) {
        void *memory;
        jcas_batch *batch = batch_of(threads, threads == 4 ? run_backwards : NULL, &memory);
        OK(jcas_batch_fork(batch, sim, policy, seeds, seed_count));
        for (uint32_t m = 0; m < M && threads == first; m++) {
            uint64_t of_sim, of_member;
            OK(jcas_batch_get(batch, m, member));
            OK(jcas_sim_hash(member, &of_member));
            OK(jcas_sim_hash(sim, &of_sim));
            CHECK((of_sim == of_member) == (seeds == NULL || seeds[m] == SEEDS[0]));
            alone(policy, batch, m, other);
        }
        jcas_rollout_out out = buffers(&got);
        OK(jcas_batch_rollout(batch, policy, NULL, 0, K, &out));
        same_futures();
        to_the_end(policy, batch);
        OK(jcas_batch_fork(batch, sim, policy, seeds, seed_count));
        in_halves(policy, batch);
        OK(jcas_batch_fork(batch, sim, NULL, seeds, seed_count));
        OK(jcas_batch_rollout(batch, NULL, expected.actions, M * K * ACTIONS, K, &out));
        same_futures();
        OK(jcas_batch_free(batch));
        free(memory);
    }
    OK(jcas_sim_free(member));
    OK(jcas_sim_free(sim));
    OK(jcas_policy_free(other));
    OK(jcas_policy_free(policy));
}

static void says(jcas_batch *batch, const char *words)
{
    char text[160];
    size_t size;
    OK(jcas_batch_message(batch, text, sizeof text, &size));
    if (strstr(text, words) == NULL)
        fprintf(stderr, "the message is \"%s\"\n", text);
    CHECK(strstr(text, words) != NULL);
}

static void abuse_outputs(jcas_batch *batch, jcas_policy *policy)
{
    struct { int32_t status; jcas_rollout_out out; } wrong[16];
    int count = 0;
    jcas_rollout_out good = buffers(&got);
#define WRONG(status_, field, value)                                                               \
    wrong[count].status = status_, wrong[count].out = good, wrong[count++].out.field = value
    WRONG(JCAS_ERROR_STRUCT_SIZE, struct_size, sizeof good - 1);
    WRONG(JCAS_ERROR_ARGUMENT, reserved, 1);
    WRONG(JCAS_ERROR_NULL, returns, NULL);
    WRONG(JCAS_ERROR_LENGTH, return_count, M - 1);
    WRONG(JCAS_ERROR_NULL, steps, NULL);
    WRONG(JCAS_ERROR_LENGTH, step_count, M + 1);
    WRONG(JCAS_ERROR_LENGTH, terminated_count, 0);
    WRONG(JCAS_ERROR_LENGTH, truncated_count, 1);
    WRONG(JCAS_ERROR_LENGTH, metrics_count, 1);
    WRONG(JCAS_ERROR_STRUCT_SIZE, metrics_size, sizeof(jcas_metrics) - 8);
    WRONG(JCAS_ERROR_LENGTH, snapshots_size, M * snapshot_size - 1);
    WRONG(JCAS_ERROR_ALIGNMENT, returns, (double *)(void *)((char *)got.returns + 4));
    WRONG(JCAS_ERROR_ARGUMENT, truncated, got.terminated + 1);
    WRONG(JCAS_ERROR_ARGUMENT, terminated, (uint8_t *)got.returns);
#undef WRONG
    for (int i = 0; i < count; i++)
        EXPECT(wrong[i].status, jcas_batch_rollout(batch, policy, NULL, 0, K, &wrong[i].out));
}

static void abuse_rollout(jcas_batch *batch, jcas_policy *policy)
{
    uint64_t before, after;
    float *actions = expected.actions;
    jcas_rollout_out out = buffers(&got);
    OK(jcas_batch_hash(batch, &before));
    mark(got.returns, sizeof got.returns);
    EXPECT(JCAS_ERROR_NULL, jcas_batch_rollout(NULL, policy, NULL, 0, K, &out));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_rollout(batch, policy, NULL, 0, K, NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_rollout(FOREIGN(jcas_batch), policy, NULL, 0, K, &out));
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_rollout(batch, FOREIGN(jcas_policy), NULL, 0, K, &out));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_batch_rollout(batch, NULL, NULL, 0, K, &out));
    says(batch, "either a policy or actions");
    EXPECT(JCAS_ERROR_ARGUMENT,
           jcas_batch_rollout(batch, policy, actions, M * K * ACTIONS, K, &out));
    says(batch, "either a policy or actions");
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_batch_rollout(batch, policy, NULL, 0, 0, &out));
    says(batch, "steps = 0: must be at least 1");
    EXPECT(JCAS_ERROR_LENGTH,
           jcas_batch_rollout(batch, NULL, actions, M * K * ACTIONS, K - 1, &out));
    says(batch, "actions");
    EXPECT(JCAS_ERROR_NULL, jcas_batch_rollout(batch, NULL, NULL, M * K * ACTIONS, K, &out));
    EXPECT(JCAS_ERROR_LENGTH,
           jcas_batch_rollout(batch, NULL, actions, M * K * ACTIONS, UINT32_MAX, &out));
    memset(actions, 0, sizeof expected.actions);
    memset(&actions[2 * K * ACTIONS + 3 * ACTIONS + 4], 0xff, sizeof(float));
    EXPECT(JCAS_ERROR_NAN, jcas_batch_rollout(batch, NULL, actions, M * K * ACTIONS, K, &out));
    says(batch, "environment 2: actions[2][0] = NaN");
    abuse_outputs(batch, policy);
    OK(jcas_batch_hash(batch, &after));
    CHECK(before == after && untouched(got.returns, sizeof got.returns));
}

/* A model of another size, and everything of it. */
static void abuse_models(jcas_batch *batch, jcas_sim *sim, jcas_policy *policy)
{
    jcas_config config;
    jcas_model *other;
    jcas_sim *foreign;
    jcas_policy *stranger;
    jcas_rollout_out out = buffers(&got);
    OK(jcas_config_default(&config, sizeof config));
    OK(jcas_model_new(&config, &other, NULL, 0));
    OK(jcas_sim_new(other, &foreign));
    OK(jcas_policy_baseline(other, "teams", NULL, &stranger, NULL, 0));
    EXPECT(JCAS_ERROR_MODEL_MISMATCH, jcas_batch_fork(batch, foreign, NULL, NULL, 0));
    EXPECT(JCAS_ERROR_MODEL_MISMATCH, jcas_batch_fork(batch, sim, stranger, NULL, 0));
    EXPECT(JCAS_ERROR_MODEL_MISMATCH, jcas_batch_rollout(batch, stranger, NULL, 0, K, &out));
    OK(jcas_policy_free(stranger));
    OK(jcas_sim_free(foreign));
    OK(jcas_model_free(other));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_fork(NULL, sim, policy, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_fork(batch, NULL, policy, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_fork(batch, sim, policy, NULL, M));
    EXPECT(JCAS_ERROR_LENGTH, jcas_batch_fork(batch, sim, policy, SEEDS, M - 1));
    says(batch, "seeds");
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_fork(batch, FOREIGN(jcas_sim), NULL, NULL, 0));
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_fork(batch, sim, FOREIGN(jcas_policy), NULL, 0));
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_fork(FOREIGN(jcas_batch), sim, policy, NULL, 0));
}

static void abuse(void)
{
    uint64_t before, after;
    jcas_batch *batch;
    jcas_sim *sim;
    jcas_policy *policy = policy_of("teams", 0);
    jcas_outcome outcome = {.struct_size = sizeof outcome};
    float actions[ACTIONS] = {0};
    jcas_rollout_out out = buffers(&got);
    OK(jcas_sim_new(model, &sim));
    OK(jcas_batch_new(model, M, 2, &batch));
    lead(policy, sim);
    OK(jcas_batch_fork(batch, sim, policy, SEEDS, M));
    abuse_rollout(batch, policy);
    abuse_models(batch, sim, policy);

    /* The policy has not seen the step before: it refuses the fork, and the batch stays. */
    OK(jcas_batch_hash(batch, &before));
    OK(jcas_sim_step(sim, actions, ACTIONS, &outcome));
    OK(jcas_sim_step(sim, actions, ACTIONS, &outcome));
    EXPECT(JCAS_ERROR_MEMORY, jcas_batch_fork(batch, sim, policy, NULL, 0));
    OK(jcas_batch_hash(batch, &after));
    CHECK(before == after);
    OK(jcas_batch_rollout(batch, policy, NULL, 0, 1, &out));
    /* Forked without its memory, it refuses the rollout. */
    OK(jcas_batch_fork(batch, sim, NULL, NULL, 0));
    EXPECT(JCAS_ERROR_MEMORY, jcas_batch_rollout(batch, policy, NULL, 0, 1, &out));
    OK(jcas_policy_forget(policy));
    OK(jcas_batch_rollout(batch, policy, NULL, 0, 1, &out));

    /* A member in the middle of a step. */
    OK(jcas_sim_step_begin(sim, actions, ACTIONS));
    OK(jcas_batch_set(batch, 3, sim));
    EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_batch_rollout(batch, policy, NULL, 0, 1, &out));
    says(batch, "environment 3");
    OK(jcas_batch_free(batch));
    OK(jcas_sim_free(sim));
    OK(jcas_policy_free(policy));
}

int main(int argc, char **argv)
{
    static const char *const NAMES[] = {NULL,     "random", "untrained", "greedy", "teams",
                                        "squads", "line",   "answer",    "plan",   "replan"};
    jcas_config config;
    jcas_model_info info = {.struct_size = sizeof info};
    CHECK(argc == 2);
    FILE *stream = fopen(argv[1], "rb");
    CHECK(stream != NULL);
    file = ARRAY(unsigned char, 1 << 20);
    length = fread(file, 1, 1 << 20, stream);
    fclose(stream);
    OK(jcas_config_default(&config, sizeof config));
    config.uav_count = UAVS;
    config.hotspot_count = HOTSPOTS;
    config.horizon_steps = HORIZON;
    OK(jcas_model_new(&config, &model, NULL, 0));
    OK(jcas_model_get_info(model, &info));
    snapshot_size = info.snapshot_size;
    expected.snapshots = ARRAY(unsigned char, M * snapshot_size);
    got.snapshots = ARRAY(unsigned char, M * snapshot_size);
    fly(NULL, JCAS_POLICY_SAMPLED, SEEDS);
    for (size_t k = 0; k < sizeof NAMES / sizeof *NAMES; k++) {
        fly(NAMES[k], JCAS_POLICY_DETERMINISTIC, NULL);
        fly(NAMES[k], JCAS_POLICY_DETERMINISTIC, SEEDS);
    }
    abuse();
    free(expected.snapshots);
    free(got.snapshots);
    free(file);
    OK(jcas_model_free(model));
    return 0;
}
