/* Steps many environments at once, as a learner does: contiguous buffers, worker threads, automatic
 * resets, and the metrics of each finished episode.
 *
 * With jcas installed and PKG_CONFIG_PATH set, as docs/c.md says:
 *
 *   libdir=$(pkg-config --variable=libdir jcas)
 *   cc batch.c $(pkg-config --cflags --libs jcas) -Wl,-rpath,"$libdir"
 *   ./a.out [environments [threads]]
 */
#include <jcas.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 300 };

static void stop_on(int32_t status, const char *what)
{
    if (status != JCAS_OK) {
        fprintf(stderr, "%s: %s\n", what, jcas_status_string(status));
        exit(1);
    }
}

static void *allocate(size_t count, size_t size)
{
    void *memory = calloc(count, size);
    if (memory == NULL) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return memory;
}

/* A UAV flies to the first hotspot that is not confirmed, by its own observation. Five entries of
 * the UAV come first. Each hotspot then has four: its offset along x and y, whether it is
 * confirmed, and whether it is known. */
static void act(const float *observation, uint32_t hotspots, float *action)
{
    const float *target = observation + 5;
    for (uint32_t j = 1; j < hotspots && target[2] != 0; j++)
        target += 4;
    if (target[0] != 0)
        action[0] = target[0] > 0 ? JCAS_MOVE_RIGHT : JCAS_MOVE_LEFT;
    else if (target[1] != 0)
        action[0] = target[1] > 0 ? JCAS_MOVE_UP : JCAS_MOVE_DOWN;
    else
        action[0] = JCAS_MOVE_STAY;
    action[1] = 1;
}

int main(int argc, char **argv)
{
    uint32_t environments = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 64;
    uint32_t threads = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 0;

    jcas_config config;
    jcas_model *model;
    jcas_batch *batch;
    stop_on(jcas_config_default(&config, sizeof config), "configuration");
    config.horizon_steps = 100;
    stop_on(jcas_model_new(&config, &model, NULL, 0), "model");
    stop_on(jcas_batch_new(model, environments, threads, &batch), "batch");

    jcas_model_info info = {.struct_size = sizeof info};
    stop_on(jcas_model_get_info(model, &info), "sizes");
    size_t acted = (size_t)environments * info.action_len;
    size_t observed = (size_t)environments * info.uav_count * info.observation_len;
    float *actions = allocate(acted, sizeof(float));
    uint64_t *seeds = allocate(environments, sizeof(uint64_t));
    jcas_metrics *metrics = allocate(environments, sizeof(jcas_metrics));
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
        .final_metrics = metrics,
        .final_metrics_count = environments,
        .metrics_size = sizeof(jcas_metrics),
    };

    for (uint32_t m = 0; m < environments; m++)
        seeds[m] = m;
    stop_on(jcas_batch_reset(batch, seeds, environments, out.observations, observed, NULL, 0),
            "reset");

    unsigned episodes = 0;
    double confirmed = 0, energy_kwh = 0;
    for (int step = 0; step < STEPS; step++) {
        for (size_t i = 0; i < (size_t)environments * info.uav_count; i++)
            act(out.observations + i * info.observation_len, info.hotspot_count, actions + 2 * i);
        stop_on(jcas_batch_step(batch, actions, acted, 1, &out), "step");
        for (uint32_t m = 0; m < environments; m++) {
            if (out.terminated[m] || out.truncated[m]) {
                episodes++;
                confirmed += metrics[m].confirmed;
                energy_kwh += metrics[m].energy_kwh;
            }
        }
    }
    printf("%u environments, %d steps, %u episodes ended: mean %.3f hotspots confirmed, %.4f kWh\n",
           environments, STEPS, episodes, episodes ? confirmed / episodes : 0.0,
           episodes ? energy_kwh / episodes : 0.0);

    free(actions);
    free(seeds);
    free(metrics);
    free(out.observations);
    free(out.rewards);
    free(out.terminated);
    free(out.truncated);
    stop_on(jcas_batch_free(batch), "end of batch");
    stop_on(jcas_model_free(model), "end of model");
    return 0;
}
