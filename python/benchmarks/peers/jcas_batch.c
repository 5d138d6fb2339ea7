/* Measures the C batch call in the same way as its peers.
 *
 *   cc -O2 jcas_batch.c -lm libjcas.a && ./a.out SECONDS ENVIRONMENTS [UAVS HOTSPOTS]
 *
 * The program prints agent-steps per second of processor time on one thread, with observations,
 * rewards and automatic resets.
 */
#include <jcas.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { ACTION_SETS = 8 };

static void stop_on(jcas_status status)
{
    if (status != JCAS_OK) {
        fprintf(stderr, "%s\n", jcas_status_string(status));
        exit(1);
    }
}

static void *allocate(size_t count, size_t size)
{
    void *memory = calloc(count, size);
    if (memory == NULL)
        exit(1);
    return memory;
}

int main(int argc, char **argv)
{
    double seconds = argc > 1 ? strtod(argv[1], NULL) : 1;
    uint32_t environments = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 256;
    jcas_config config;
    stop_on(jcas_config_default(&config, sizeof config));
    config.uav_count = argc > 3 ? (uint32_t)strtoul(argv[3], NULL, 10) : 15;
    config.hotspot_count = argc > 4 ? (uint32_t)strtoul(argv[4], NULL, 10) : 7;
    jcas_model *model;
    jcas_batch *batch;
    stop_on(jcas_model_new(&config, &model, NULL, 0));
    stop_on(jcas_batch_new(model, environments, 1, &batch));

    jcas_model_info info = {.struct_size = sizeof info};
    stop_on(jcas_model_get_info(model, &info));
    size_t acting = (size_t)environments * info.action_len;
    size_t observed = (size_t)environments * info.uav_count * info.observation_len;
    float *actions = allocate(ACTION_SETS * acting, sizeof *actions);
    for (size_t i = 0; i < ACTION_SETS * acting; i++)
        actions[i] = (float)rand() / (float)RAND_MAX * 2 - 1;
    uint64_t *seeds = allocate(environments, sizeof *seeds);
    for (uint32_t m = 0; m < environments; m++)
        seeds[m] = m;
    jcas_batch_out out = {
        .struct_size = sizeof out,
        .observations = allocate(observed, sizeof(float)),
        .observation_count = observed,
        .rewards = allocate(environments, sizeof(float)),
        .reward_count = environments,
        .terminated = allocate(environments, 1),
        .terminated_count = environments,
        .truncated = allocate(environments, 1),
        .truncated_count = environments,
    };
    stop_on(jcas_batch_reset(batch, seeds, environments, out.observations, observed, NULL, 0));

    clock_t begun = clock(), now = begun;
    size_t steps = 0;
    while ((double)(now - begun) < seconds * CLOCKS_PER_SEC) {
        stop_on(jcas_batch_step(batch, actions + steps % ACTION_SETS * acting, acting, 1, &out));
        steps++;
        now = clock();
    }
    double agent_steps = (double)steps * environments * info.uav_count;
    printf("%.0f\n", agent_steps / ((double)(now - begun) / CLOCKS_PER_SEC));
    return 0;
}
