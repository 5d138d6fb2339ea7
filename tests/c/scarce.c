/* A system whose memory ends at the k-th allocation, for k = 0 to 100: a status, never the end of the program.
 * Calls that promise not to allocate do not. */
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
static float actions[M * 2 * N], *observations, rewards[M];
static uint8_t flags[2][M];
static size_t observed;

/* The call succeeds and asks for nothing. */
#define FREE_OF_MEMORY(status, call)                                                                   \
    do {                                                                                               \
        long before_ = asked;                                                                          \
        EXPECT(status, call);                                                                          \
        CHECK(asked == before_);                                                                       \
    } while (0)

static void texts(void)
{
    const char *good = "preset = 'paper'\nquorum = 2\ndepots = [[1, 2], [3, 4]]\ntarget_visibility = \"hidden\"";
    const char *bad[] = {"quorum = 0", "quorum = = 1", "nothing = 1", "depots = [[99, 0]]", "quorum = 'three'"};
    const char *json = "{\"quorum\": 2, \"range_min_m\": null}", *twice = "{\"quorum\": 2, \"quorum\": 2}";
    static char text[1 << 15];
    char message[200];
    jcas_config other, wrong = config;
    size_t length;
    uint64_t hash;
    wrong.quorum = 0;
    FREE_OF_MEMORY(JCAS_OK, jcas_config_from_toml(good, strlen(good), &other, sizeof other, NULL, 0));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        FREE_OF_MEMORY(JCAS_ERROR_CONFIG, jcas_config_from_toml(bad[i], strlen(bad[i]), &other, sizeof other,
                                                                message, sizeof message));
    FREE_OF_MEMORY(JCAS_OK, jcas_config_from_json(json, strlen(json), &other, sizeof other, NULL, 0));
    FREE_OF_MEMORY(JCAS_ERROR_CONFIG,
                   jcas_config_from_json(twice, strlen(twice), &other, sizeof other, message, sizeof message));
    FREE_OF_MEMORY(JCAS_ERROR_CONFIG, jcas_config_preset("best", 4, &other, sizeof other, NULL, 0));
    FREE_OF_MEMORY(JCAS_ERROR_CONFIG, jcas_config_validate(&wrong, NULL, 0));
    FREE_OF_MEMORY(JCAS_ERROR_CONFIG, jcas_config_validate(&wrong, message, sizeof message));
    FREE_OF_MEMORY(JCAS_ERROR_CONFIG, jcas_config_hash(&wrong, &hash));
    FREE_OF_MEMORY(JCAS_ERROR_CONFIG, jcas_model_layout(&wrong, &length, &length, NULL, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_config_to_json(&config, text, sizeof text, &length));
    FREE_OF_MEMORY(JCAS_OK, jcas_config_to_toml(&config, text, sizeof text, &length));
    FREE_OF_MEMORY(JCAS_OK, jcas_config_fields(text, sizeof text, &length));
}

/* Steps by parts and whole, with refusals and their words. */
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
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_step_sense_over(sim, detections, N * HOTSPOTS));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_step_communicate_over(sim, links, N * N, NULL, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_step_end(sim, &outcome));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_detections(sim, detections, N * HOTSPOTS));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_get_throughputs(sim, throughputs, N * N));
    FREE_OF_MEMORY(JCAS_ERROR_ARGUMENT, jcas_sim_set_battery(sim, N, 0));
    FREE_OF_MEMORY(JCAS_OK, jcas_sim_message(sim, message, sizeof message, &length));
    CHECK(strcmp(message, "uav = 4: must be below uav_count") == 0);
    FREE_OF_MEMORY(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_step_end(sim, &outcome));
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
}

/* Whether the status says that memory ended; any other must be success. */
static int refused(int32_t status)
{
    CHECK(status == JCAS_OK || status == JCAS_ERROR_RESOURCES);
    return status != JCAS_OK;
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

int main(void)
{
    OK(jcas_config_default(&config, sizeof config));
    config.uav_count = N;
    config.hotspot_count = HOTSPOTS;
    observed = (size_t)M * N * (11 + 4 * HOTSPOTS + 3 * (N - 1));
    observations = ARRAY(float, observed);
    int refusals = 0;
    for (long k = 0; k <= 100; k++) {
        left = k;
        texts();
        refusals += build(k);
    }
    CHECK(refusals > 0 && build(-1) == 0);
    free(observations);
    puts("no end of memory ended the program");
    return 0;
}
