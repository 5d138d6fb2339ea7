/* A system whose memory ends at the k-th allocation, for k = 0 to 100. Each call then returns a
 * status and never ends the program. Calls that promise not to allocate do not allocate. */
#include "check.h"

#include <errno.h>

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);

static volatile long left = -1; /* allocations that still succeed; negative: all */
static volatile long asked;

static int ends_here(void)
{
    asked = asked + 1;
    if (left < 0)
        return 0;
    if (left == 0) {
        errno = ENOMEM; /* as the C library itself relies on */
        return 1;
    }
    left = left - 1;
    return 0;
}

void *malloc(size_t size)
{
    return ends_here() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return ends_here() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *memory, size_t size)
{
    return ends_here() ? NULL : __libc_realloc(memory, size);
}

int posix_memalign(void **memory, size_t alignment, size_t size)
{
    if (ends_here())
        return ENOMEM;
    *memory = __libc_memalign(alignment, size);
    return *memory == NULL;
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return ends_here() ? NULL : __libc_memalign(alignment, size);
}

enum { N = 4, HOTSPOTS = 3, M = 8 };

static jcas_config config;
static unsigned char policy_file[1 << 20], snapshot[1 << 16];
static _Alignas(16) unsigned char arena[1 << 20], batch_arena[1 << 18], model_arena[1 << 17],
    sim_arena[1 << 15];
static size_t policy_length;
static uint64_t workspace[1 << 12];
static char trace[1 << 18];
static size_t trace_length;
static float actions[M * 2 * N], *observations, rewards[M];
static uint8_t flags[2][M];
static size_t observed;

/* Whether the status reports exhausted memory; any other status must be success. */
static int refused(int32_t status)
{
    CHECK(status == JCAS_OK || status == JCAS_ERROR_RESOURCES);
    return status != JCAS_OK;
}

/* Checks that a call succeeds and allocates nothing. */
#define FREE_OF_MEMORY(status, call)                                                               \
    do {                                                                                           \
        long before_ = asked;                                                                      \
        EXPECT(status, call);                                                                      \
        CHECK(asked == before_);                                                                   \
    } while (0)

static void texts(void)
{
    const char *good =
        "preset = 'paper'\nquorum = 2\ndepots = [[1, 2], [3, 4]]\ntarget_visibility = \"hidden\"";
    const char *bad[] = {
        "quorum = 0",
        "quorum = = 1",
        "nothing = 1",
        "depots = [[99, 0]]",
        "quorum = 'three'",
        "detection_curve = 'table'\ndetection_table = [[20, 0.1], [80, 0.2]]",
    };
    const char *json = "{\"quorum\": 2, \"range_min_m\": null}",
               *twice = "{\"quorum\": 2, \"quorum\": 2}";
    static char text[1 << 15];
    char message[200];
    jcas_config other, wrong = config;
    size_t length;
    uint64_t hash;
    wrong.quorum = 0;
    FREE_OF_MEMORY(JCAS_OK,
                   jcas_config_from_toml(good, strlen(good), &other, sizeof other, NULL, 0));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        FREE_OF_MEMORY(JCAS_ERROR_CONFIG,
                       jcas_config_from_toml(bad[i], strlen(bad[i]), &other, sizeof other, message,
                                             sizeof message));
    FREE_OF_MEMORY(JCAS_OK,
                   jcas_config_from_json(json, strlen(json), &other, sizeof other, NULL, 0));
    FREE_OF_MEMORY(JCAS_ERROR_CONFIG, jcas_config_from_json(twice, strlen(twice), &other,
                                                            sizeof other, message, sizeof message));
    FREE_OF_MEMORY(JCAS_ERROR_CONFIG, jcas_config_preset("best", 4, &other, sizeof other, NULL, 0));
    FREE_OF_MEMORY(JCAS_ERROR_CONFIG, jcas_config_validate(&wrong, NULL, 0));
    FREE_OF_MEMORY(JCAS_ERROR_CONFIG, jcas_config_validate(&wrong, message, sizeof message));
    FREE_OF_MEMORY(JCAS_ERROR_CONFIG, jcas_config_hash(&wrong, &hash));
    FREE_OF_MEMORY(JCAS_ERROR_CONFIG, jcas_model_layout(&wrong, &length, &length, NULL, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_config_to_json(&config, text, sizeof text, &length));
    FREE_OF_MEMORY(JCAS_OK, jcas_config_to_toml(&config, text, sizeof text, &length));
    FREE_OF_MEMORY(JCAS_OK, jcas_config_fields(text, sizeof text, &length));
}

/* Steps by parts and whole, with refusals and their messages. */
static void fly(jcas_sim *sim)
{
    jcas_outcome outcome = {.struct_size = sizeof outcome};
    char message[200];
    size_t length;
    uint8_t links[N * N] = {0}, detections[N * HOTSPOTS] = {0};
    double throughputs[N * N];
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_reset(sim, 4));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_step(sim, actions, 2 * N, &outcome));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_step_begin(sim, actions, 2 * N));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_ground(sim, 1));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_confirm_hotspot(sim, 1));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_step_sense_with(sim, detections, N * HOTSPOTS));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_step_communicate_with(sim, links, N * N, NULL, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_step_end(sim, &outcome));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_detections(sim, detections, N * HOTSPOTS));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_throughputs(sim, throughputs, N * N));
    FREE_OF_MEMORY(JCAS_ERROR_ARGUMENT, jcas_sim_set_battery(sim, N, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_message(sim, message, sizeof message, &length));
    CHECK(strcmp(message, "uav = 4: must be below uav_count") == 0);
    FREE_OF_MEMORY(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_step_end(sim, &outcome));
}

/* Makes every call that only reads, copies, saves or loads. */
static void read(const jcas_model *model, jcas_sim *sim)
{
    jcas_model_info info = {.struct_size = sizeof info};
    jcas_episode episode = {.struct_size = sizeof episode};
    jcas_metrics metrics = {.struct_size = sizeof metrics};
    jcas_radio radio = {.struct_size = sizeof radio};
    jcas_observation_field fields[JCAS_OBSERVATION_FIELDS];
    jcas_config other;
    jcas_uav uavs[N];
    jcas_hotspot hotspots[HOTSPOTS];
    uint8_t small[12 * 12];
    double reals[12 * N];
    float seen[N * 64];
    uint64_t hash;
    size_t size, alignment;
    FREE_OF_MEMORY(JCAS_OK, jcas_model_get_info(model, &info));
    CHECK(info.snapshot_size <= sizeof snapshot && info.observation_len <= 64 &&
          info.global_len <= N * 64);
    FREE_OF_MEMORY(JCAS_OK, jcas_model_get_config(model, &other, sizeof other));
    FREE_OF_MEMORY(JCAS_OK, jcas_model_get_radio(model, 1, 2, 0.1, &radio));
    FREE_OF_MEMORY(JCAS_OK, jcas_model_observation_fields(model, fields, JCAS_OBSERVATION_FIELDS,
                                                          sizeof *fields));
    FREE_OF_MEMORY(JCAS_OK, jcas_model_layout(&config, &size, &alignment, NULL, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_layout(model, &size, &alignment));
    FREE_OF_MEMORY(JCAS_OK, jcas_trace_layout(model, &size, &alignment));
    CHECK(size <= sizeof workspace);
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_episode(sim, &episode));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_metrics(sim, &metrics));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_uavs(sim, uavs, N, sizeof *uavs));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_hotspots(sim, hotspots, HOTSPOTS, sizeof *hotspots));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_links(sim, small, N * N));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_knowledge(sim, small, N * HOTSPOTS));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_visited(sim, small, sizeof small));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_rewards(sim, reals, 12));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_uav_rewards(sim, reals, N));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_uav_reward_components(sim, reals, 12 * N));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_observe(sim, seen, (size_t)N * info.observation_len));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_observe_global(sim, seen, info.global_len));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_hash(sim, &hash));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_save(sim, snapshot, info.snapshot_size));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_load(sim, snapshot, info.snapshot_size));
    snapshot[info.snapshot_size / 2] ^= 1;
    FREE_OF_MEMORY(JCAS_ERROR_CORRUPT, jcas_sim_load(sim, snapshot, info.snapshot_size));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_fork(sim, sim));
}

static int32_t take(const char *bytes, size_t count, void *context)
{
    (void)context;
    if (count > sizeof trace - trace_length)
        return 1;
    memcpy(trace + trace_length, bytes, count);
    trace_length += count;
    return 0;
}

/* Records an episode, ends the recording, and verifies it. */
static void record(jcas_sim *sim)
{
    jcas_recorder recorder = {.struct_size = sizeof recorder,
                              .write = take,
                              .memory = workspace,
                              .memory_size = sizeof workspace};
    jcas_cell starts[N] = {{1, 1}, {2, 2}, {3, 3}, {4, 4}},
              hotspots[HOTSPOTS] = {{0, 1}, {0, 2}, {0, 3}};
    uint64_t charges[N] = {1, 2, 3, 4};
    char message[200];
    jcas_config other;
    trace_length = 0;
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_record(sim, 3, &recorder));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_set_starts(sim, starts, N));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_set_hotspots(sim, hotspots, HOTSPOTS));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_set_batteries(sim, charges, N));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_set_battery(sim, 0, 9));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_move_hotspot(sim, 0, 5, 5));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_step_begin(sim, actions, 2 * N));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_set_positions(sim, starts, N));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_step_sense(sim));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_step_communicate(sim));
    jcas_outcome outcome = {.struct_size = sizeof outcome};
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_step_end(sim, &outcome));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_record_end(sim));
    FREE_OF_MEMORY(JCAS_OK, jcas_trace_config(trace, trace_length, &other, sizeof other, message,
                                              sizeof message));
    FREE_OF_MEMORY(JCAS_OK, jcas_trace_verify(sim, workspace, sizeof workspace, trace, trace_length,
                                              message, sizeof message));
    trace[trace_length / 2] ^= 1;
    FREE_OF_MEMORY(JCAS_ERROR_CORRUPT, jcas_trace_verify(sim, workspace, sizeof workspace, trace,
                                                         trace_length, message, sizeof message));
}

/* A trained policy allocates when it is loaded, and never again. */
static int fly_policy(const jcas_model *model, jcas_sim *sim)
{
    jcas_policy *policy;
    char message[200];
    size_t size, alignment;
    FREE_OF_MEMORY(
        JCAS_OK, jcas_policy_layout(model, policy_file, policy_length, &size, &alignment, NULL, 0));
    FREE_OF_MEMORY(JCAS_ERROR_CORRUPT,
                   jcas_policy_layout(model, policy_file, policy_length - 1, &size, &alignment,
                                      message, sizeof message));
    CHECK(size <= sizeof arena);
    FREE_OF_MEMORY(JCAS_OK, jcas_policy_init(arena, sizeof arena, model, policy_file, policy_length,
                                             &policy, NULL, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_policy_act(policy, sim, actions, 2 * N));
    FREE_OF_MEMORY(JCAS_OK, jcas_policy_set_mode(policy, JCAS_POLICY_SAMPLED));
    FREE_OF_MEMORY(JCAS_OK, jcas_policy_act(policy, sim, actions, 2 * N));
    FREE_OF_MEMORY(JCAS_OK, jcas_policy_free(policy));
    if (refused(
            jcas_policy_load(model, policy_file, policy_length, &policy, message, sizeof message)))
        return 1;
    FREE_OF_MEMORY(JCAS_OK, jcas_policy_act(policy, sim, actions, 2 * N));
    OK(jcas_policy_free(policy));
    memset(actions, 0, sizeof actions);
    return 0;
}

enum { FLEET = 12, TARGETS = 6, MEMBERS = 3 };

/* Runs a mission in which every call for actions first has memory for `k` allocations only. A
 * refused call changes nothing, and its repetition continues the baseline's plan. Returns the hash
 * of the last state. */
static uint64_t fly_with(long k, jcas_policy *policy, jcas_sim *sim, int *refusals)
{
    float asked_for[2 * FLEET];
    jcas_outcome outcome = {.struct_size = sizeof outcome};
    uint64_t hash;
    OK(jcas_sim_reset(sim, 3));
    while (!outcome.terminated && !outcome.truncated) {
        mark(asked_for, sizeof asked_for);
        left = k;
        int without = refused(jcas_policy_act(policy, sim, asked_for, 2 * FLEET));
        left = -1;
        if (without) {
            CHECK(untouched(asked_for, sizeof asked_for));
            OK(jcas_policy_act(policy, sim, asked_for, 2 * FLEET));
            *refusals += 1;
        }
        OK(jcas_sim_step(sim, asked_for, 2 * FLEET, &outcome));
    }
    OK(jcas_sim_hash(sim, &hash));
    return hash;
}

static void fly_batch_with(long k, jcas_policy *policy, jcas_batch *batch)
{
    float asked_for[MEMBERS * 2 * FLEET];
    mark(asked_for, sizeof asked_for);
    left = k;
    int without = refused(jcas_policy_act_batch(policy, batch, asked_for, MEMBERS * 2 * FLEET));
    left = -1;
    if (without) {
        CHECK(untouched(asked_for, sizeof asked_for));
        OK(jcas_policy_act_batch(policy, batch, asked_for, MEMBERS * 2 * FLEET));
    }
}

/* Baselines plan on the heap: the call reports an exhausted heap at any allocation. */
static void fly_baselines(void)
{
    static const char *const NAMES[] = {"random", "untrained", "greedy", "teams",
                                        "squads", "line",      "answer"};
    jcas_config fleet = config;
    jcas_model *model;
    jcas_sim *sim;
    jcas_batch *batch;
    jcas_policy *policy = NULL;
    char message[200];
    fleet.uav_count = FLEET;
    fleet.hotspot_count = TARGETS;
    OK(jcas_model_new(&fleet, &model, NULL, 0));
    OK(jcas_sim_new(model, &sim));
    OK(jcas_batch_new(model, MEMBERS, 1, &batch));
    FREE_OF_MEMORY(JCAS_ERROR_ARGUMENT,
                   jcas_policy_baseline(model, "swan", NULL, &policy, message, sizeof message));
    FREE_OF_MEMORY(JCAS_ERROR_ARGUMENT,
                   jcas_policy_baseline(model, "greedy", "2", &policy, message, sizeof message));
    for (size_t name = 0; name < sizeof NAMES / sizeof *NAMES; name++) {
        uint64_t hash = 0;
        int refusals = 0;
        for (long k = -1; k <= 100; k += k < 12 ? 1 : 8) {
            left = k;
            while (refused(jcas_policy_baseline(model, NAMES[name], "0.2", &policy, message,
                                                sizeof message))) {
                CHECK(policy == NULL);
                refusals++;
                left = -1;
            }
            left = -1;
            fly_batch_with(k, policy, batch);
            uint64_t now = fly_with(k, policy, sim, &refusals);
            hash = k == -1 ? now : hash;
            CHECK(now == hash);
            OK(jcas_policy_free(policy));
            policy = NULL;
        }
        CHECK(refusals > 0);
    }
    OK(jcas_batch_free(batch));
    OK(jcas_sim_free(sim));
    OK(jcas_model_free(model));
}

/* An annealing asks for all of its memory first, and following a plan takes none. */
static void fly_plans(void)
{
    jcas_config fleet = config;
    jcas_plan_settings settings = {.struct_size = sizeof settings, .iterations = 500};
    jcas_cell hotspots[TARGETS] = {{0, 1}, {1, 9}, {9, 1}, {3, 3}, {7, 11}, {11, 11}};
    jcas_model *model;
    jcas_sim *sim;
    jcas_plan *plan = NULL, *read = NULL;
    jcas_policy *policy = NULL;
    jcas_plan_info info = {.struct_size = sizeof info};
    jcas_outcome outcome = {.struct_size = sizeof outcome};
    float asked_for[2 * FLEET];
    char message[200];
    size_t length, again;
    fleet.uav_count = FLEET;
    fleet.hotspot_count = TARGETS;
    OK(jcas_model_new(&fleet, &model, NULL, 0));
    OK(jcas_sim_new(model, &sim));
    left = 0;
    CHECK(refused(jcas_plan_search(model, &settings, &plan, message, sizeof message)));
    CHECK(plan == NULL && strstr(message, "bytes of memory") != NULL);
    CHECK(refused(jcas_plan_tour(model, hotspots, TARGETS, &settings, &plan, NULL, 0)));
    CHECK(plan == NULL);
    CHECK(refused(jcas_policy_baseline(model, "replan", NULL, &policy, NULL, 0)) && policy == NULL);
    left = -1;
    OK(jcas_plan_tour(model, hotspots, TARGETS, &settings, &plan, NULL, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_plan_get_info(plan, &info));
    FREE_OF_MEMORY(JCAS_OK, jcas_plan_to_json(plan, NULL, 0, &length));
    char *text = ARRAY(char, length + 1);
    FREE_OF_MEMORY(JCAS_OK, jcas_plan_to_json(plan, text, length + 1, &again));
    left = 0;
    CHECK(refused(jcas_plan_from_json(model, text, length, &read, NULL, 0)) && read == NULL);
    CHECK(refused(jcas_policy_follow(model, plan, &policy)) && policy == NULL);
    left = -1;
    free(text);
    OK(jcas_policy_follow(model, plan, &policy));
    OK(jcas_plan_free(plan));
    OK(jcas_sim_reset(sim, 3));
    OK(jcas_policy_act(policy, sim, asked_for, 2 * FLEET)); /* room for one simulation */
    while (!outcome.terminated && !outcome.truncated) {
        FREE_OF_MEMORY(JCAS_OK, jcas_policy_act(policy, sim, asked_for, 2 * FLEET));
        OK(jcas_sim_step(sim, asked_for, 2 * FLEET, &outcome));
    }
    OK(jcas_policy_free(policy));
    for (int renewed = 0; renewed < 2; renewed++) {
        OK(jcas_policy_baseline(model, renewed ? "replan" : "plan", NULL, &policy, NULL, 0));
        OK(jcas_sim_reset(sim, 3));
        for (long k = 0; k < 2; k++) { /* no room for the policy's plans, then none for annealing */
            mark(asked_for, sizeof asked_for);
            left = k;
            CHECK(refused(jcas_policy_act(policy, sim, asked_for, 2 * FLEET)));
            left = -1;
            CHECK(untouched(asked_for, sizeof asked_for));
        }
        OK(jcas_policy_act(policy, sim, asked_for, 2 * FLEET));
        OK(jcas_policy_free(policy));
    }
    OK(jcas_sim_free(sim));
    OK(jcas_model_free(model));
}

static void step(jcas_batch *batch)
{
    jcas_batch_out out = {.struct_size = sizeof out,
                          .observations = observations, .observation_count = observed,
                          .rewards = rewards, .reward_count = M,
                          .terminated = flags[0], .terminated_count = M,
                          .truncated = flags[1], .truncated_count = M};
    for (int i = 0; i < 20; i++)
        FREE_OF_MEMORY(JCAS_OK, jcas_batch_step(batch, actions, M * 2 * N, 1, &out));
    uint64_t seeds[M] = {0}, hash;
    uint8_t mask[M] = {1};
    char message[200];
    size_t length;
    FREE_OF_MEMORY(JCAS_OK, jcas_batch_reset(batch, seeds, M, observations, observed, NULL, 0));
    FREE_OF_MEMORY(
        JCAS_OK, jcas_batch_reset_some(batch, mask, M, seeds, M, observations, observed, NULL, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_batch_observe(batch, observations, observed, NULL, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_batch_hash(batch, &hash));
    FREE_OF_MEMORY(JCAS_ERROR_LENGTH, jcas_batch_save(batch, snapshot, 1));
    FREE_OF_MEMORY(JCAS_ERROR_LENGTH, jcas_batch_load(batch, snapshot, 1));
    FREE_OF_MEMORY(JCAS_OK, jcas_batch_message(batch, message, sizeof message, &length));
}

/* The library allocates nothing in the caller's memory. */
static void build_in_place(void)
{
    jcas_model *model;
    jcas_sim *sim;
    jcas_batch *batch;
    jcas_policy *policy;
    jcas_batch_options options = {.struct_size = sizeof options, .environments = M, .threads = 1};
    size_t size, alignment;
    uint8_t maps[1];
    left = 0;
    FREE_OF_MEMORY(JCAS_OK,
                   jcas_model_init(model_arena, sizeof model_arena, &config, &model, NULL, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_init(sim_arena, sizeof sim_arena, model, &sim));
    FREE_OF_MEMORY(JCAS_OK, jcas_batch_layout(model, &options, &size, &alignment));
    FREE_OF_MEMORY(JCAS_OK,
                   jcas_batch_init(batch_arena, sizeof batch_arena, model, &options, &batch));
    FREE_OF_MEMORY(JCAS_OK, jcas_policy_init(arena, sizeof arena, model, policy_file, policy_length,
                                             &policy, NULL, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_policy_act_batch(policy, batch, actions, M * 2 * N));
    FREE_OF_MEMORY(JCAS_OK, jcas_batch_get(batch, 1, sim));
    FREE_OF_MEMORY(JCAS_OK, jcas_batch_set(batch, 2, sim));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_search_maps(sim, maps, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_false_alarms(sim, maps, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_false_confirmations(sim, maps, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_reports(sim, maps, 0));
    memset(actions, 0, sizeof actions);
    step(batch);
    FREE_OF_MEMORY(JCAS_OK, jcas_policy_free(policy));
    FREE_OF_MEMORY(JCAS_OK, jcas_batch_free(batch));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_free(sim));
    FREE_OF_MEMORY(JCAS_OK, jcas_model_free(model));
    left = -1;
}

static int build(long k)
{
    jcas_model *model;
    jcas_sim *sim;
    int refusals = 0;
    left = k;
    if (refused(jcas_model_new(&config, &model, NULL, 0))) {
        left = -1;
        return 1;
    }
    if (refused(jcas_sim_new(model, &sim)))
        refusals++;
    else {
        fly(sim);
        read(model, sim);
        record(sim);
        left = k;
        refusals += fly_policy(model, sim);
        OK(jcas_sim_free(sim));
    }
    for (uint32_t threads = 0; threads <= 4; threads++) {
        jcas_batch *batch;
        left = k;
        if (refused(jcas_batch_new(model, M, threads, &batch))) {
            refusals++;
            continue;
        }
        step(batch);
        OK(jcas_batch_free(batch));
    }
    left = -1;
    OK(jcas_model_free(model)); /* whatever failed holds on to nothing */
    return refusals;
}

int main(int argc, char **argv)
{
    CHECK(argc == 2);
    FILE *file = fopen(argv[1], "rb");
    CHECK(file != NULL);
    policy_length = fread(policy_file, 1, sizeof policy_file, file);
    fclose(file);
    OK(jcas_config_default(&config, sizeof config));
    config.uav_count = N;
    config.hotspot_count = HOTSPOTS;
    observed = (size_t)M * N * (11 + 4 * HOTSPOTS + 3 * (N - 1));
    observations = ARRAY(float, observed);
    int refusals = 0;
    build_in_place();
    for (long k = 0; k <= 100; k++) {
        left = k;
        texts();
        refusals += build(k);
    }
    CHECK(refusals > 0 && build(-1) == 0);
    fly_baselines();
    fly_plans();
    free(observations);
    puts("no end of memory ended the program");
    return 0;
}
