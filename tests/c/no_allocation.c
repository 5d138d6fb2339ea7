/* The library allocates nothing in the caller's memory: this program's allocator counts calls. */
#include "check.h"

/* The C library's allocator, which these functions call. */
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);

static volatile size_t allocations; /* compilers think they know what malloc changes */

void *malloc(size_t size)
{
    allocations = allocations + 1;
    return __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    allocations = allocations + 1;
    return __libc_calloc(count, size);
}

void *realloc(void *memory, size_t size)
{
    allocations = allocations + 1;
    return __libc_realloc(memory, size);
}

int posix_memalign(void **memory, size_t alignment, size_t size)
{
    allocations = allocations + 1;
    *memory = __libc_memalign(alignment, size);
    return *memory == NULL;
}

void *aligned_alloc(size_t alignment, size_t size)
{
    allocations = allocations + 1;
    return __libc_memalign(alignment, size);
}

enum { N = 10, HOTSPOTS = 5, OBSERVED = N * (11 + 4 * HOTSPOTS + 3 * (N - 1)) };

static _Alignas(16) unsigned char model_memory[1 << 16], sim_memory[1 << 16], twin_memory[1 << 16];
static unsigned char snapshot[1 << 14];
static float observations[OBSERVED], global[6 * N + 4 * HOTSPOTS + 4], actions[2 * N];
static uint8_t links[N * N];
static uint64_t workspace[1 << 12];
static char trace[1 << 17];
static size_t trace_length;

static int32_t take(const char *bytes, size_t count, void *context)
{
    (void)context;
    if (count > sizeof trace - trace_length)
        return 1;
    memcpy(trace + trace_length, bytes, count);
    trace_length += count;
    return 0;
}

/* Records an episode, and replays it from the trace. */
static void record(const jcas_model *model, jcas_sim *sim)
{
    jcas_outcome outcome = {.struct_size = sizeof outcome};
    jcas_recorder recorder = {.struct_size = sizeof recorder,
                              .write = take,
                              .memory = workspace,
                              .memory_size = sizeof workspace};
    jcas_config config;
    size_t size, alignment;
    OK(jcas_trace_layout(model, &size, &alignment));
    CHECK(size <= sizeof workspace);
    OK(jcas_sim_record(sim, 4, &recorder));
    for (int step = 0; step < 40; step++) {
        OK(jcas_sim_step_begin(sim, actions, 2 * N));
        OK(jcas_sim_ground(sim, 1));
        OK(jcas_sim_step_sense(sim));
        OK(jcas_sim_step_communicate(sim));
        OK(jcas_sim_step_end(sim, &outcome));
    }
    OK(jcas_sim_record_end(sim));
    OK(jcas_trace_config(trace, trace_length, &config, sizeof config, NULL, 0));
    OK(jcas_trace_verify(sim, workspace, sizeof workspace, trace, trace_length, NULL, 0));
}

static void fly(jcas_sim *sim, jcas_sim *twin, size_t snapshot_size)
{
    jcas_outcome outcome = {.struct_size = sizeof outcome};
    jcas_episode episode = {.struct_size = sizeof episode};
    jcas_metrics metrics = {.struct_size = sizeof metrics};
    jcas_uav uavs[N];
    jcas_cell cells[N];
    uint64_t hash;
    OK(jcas_sim_reset(sim, 4));
    for (int step = 0; step < 40; step++) {
        OK(jcas_sim_step(sim, actions, 2 * N, &outcome));
        OK(jcas_sim_observe(sim, observations, OBSERVED));
        OK(jcas_sim_observe_global(sim, global, sizeof global / sizeof *global));
        OK(jcas_sim_get_episode(sim, &episode));
        OK(jcas_sim_get_metrics(sim, &metrics));
        OK(jcas_sim_get_uavs(sim, uavs, N, sizeof *uavs));
        OK(jcas_sim_get_links(sim, links, N * N));
        OK(jcas_sim_hash(sim, &hash));
        OK(jcas_sim_fork(sim, twin));
        for (int i = 0; i < N; i++)
            cells[i].x = uavs[i].x, cells[i].y = uavs[i].y;
        OK(jcas_sim_step_begin(twin, actions, 2 * N));
        OK(jcas_sim_set_positions(twin, cells, N));
        OK(jcas_sim_step_sense(twin));
        OK(jcas_sim_step_communicate_with(twin, links, N * N, NULL, 0));
        OK(jcas_sim_step_end(twin, &outcome));
        OK(jcas_sim_save(twin, snapshot, snapshot_size));
        OK(jcas_sim_load(twin, snapshot, snapshot_size));
        actions[0] = NAN;
        EXPECT(JCAS_ERROR_NAN, jcas_sim_step(sim, actions, 2 * N, &outcome));
        actions[0] = 0;
    }
}

int main(void)
{
    size_t before = allocations;
    void *volatile counted = malloc(1);
    free(counted);
    CHECK(allocations == before + 1);

    jcas_config config;
    jcas_model *model;
    jcas_sim *sim, *twin;
    jcas_model_info info = {.struct_size = sizeof info};
    before = allocations;
    OK(jcas_config_default(&config, sizeof config));
    OK(jcas_model_init(model_memory, sizeof model_memory, &config, &model, NULL, 0));
    OK(jcas_model_get_info(model, &info));
    CHECK(info.snapshot_size <= sizeof snapshot);
    OK(jcas_sim_init(sim_memory, sizeof sim_memory, model, &sim));
    OK(jcas_sim_init(twin_memory, sizeof twin_memory, model, &twin));
    fly(sim, twin, info.snapshot_size);
    record(model, sim);
    OK(jcas_sim_free(twin));
    OK(jcas_sim_free(sim));
    OK(jcas_model_free(model));
    CHECK(allocations == before);

    /* A batch allocates when it is built, and not when it steps. */
    OK(jcas_model_init(model_memory, sizeof model_memory, &config, &model, NULL, 0));
    jcas_batch *batch;
    OK(jcas_batch_new(model, 1, 1, &batch));
    CHECK(allocations > before);
    before = allocations;
    float reward;
    uint8_t terminated, truncated;
    uint64_t seed = 1;
    jcas_batch_out out = {.struct_size = sizeof out,
                          .observations = observations,
                          .observation_count = OBSERVED,
                          .rewards = &reward,
                          .reward_count = 1,
                          .terminated = &terminated,
                          .terminated_count = 1,
                          .truncated = &truncated,
                          .truncated_count = 1};
    OK(jcas_batch_reset(batch, &seed, 1, observations, OBSERVED, NULL, 0));
    for (int step = 0; step < 150; step++)
        OK(jcas_batch_step(batch, actions, 2 * N, 1, &out));
    CHECK(allocations == before);
    OK(jcas_batch_free(batch));
    OK(jcas_model_free(model));
    puts("nothing was allocated");
    return 0;
}
