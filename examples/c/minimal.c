/* Flies every UAV to the first unconfirmed hotspot. With jcas installed as docs/c.md says:
 *   libdir=$(pkg-config --variable=libdir jcas)
 *   cc minimal.c $(pkg-config --cflags --libs jcas) -Wl,-rpath,"$libdir" && ./a.out
 */
#include <jcas.h>
#include <stdio.h>

#define N 10
#define HOTSPOTS 5

static float toward(jcas_uav from, jcas_hotspot to)
{
    if (from.x != to.x)
        return from.x < to.x ? JCAS_MOVE_RIGHT : JCAS_MOVE_LEFT;
    if (from.y != to.y)
        return from.y < to.y ? JCAS_MOVE_UP : JCAS_MOVE_DOWN;
    return JCAS_MOVE_STAY;
}

int main(void)
{
    jcas_config config;
    jcas_model *model;
    jcas_sim *sim;
    char message[256] = "";
    jcas_config_default(&config, sizeof config);
    config.uav_count = N;
    config.hotspot_count = HOTSPOTS;
    if (jcas_model_new(&config, &model, message, sizeof message) != JCAS_OK) {
        fprintf(stderr, "%s\n", message);
        return 1;
    }
    if (jcas_sim_new(model, &sim) != JCAS_OK || jcas_sim_reset(sim, 42) != JCAS_OK)
        return 1;

    jcas_outcome outcome = {.struct_size = sizeof outcome};
    while (!outcome.terminated && !outcome.truncated) {
        jcas_uav uavs[N];
        jcas_hotspot hotspots[HOTSPOTS];
        float actions[2 * N];
        jcas_sim_get_uavs(sim, uavs, N, sizeof *uavs);
        jcas_sim_get_hotspots(sim, hotspots, HOTSPOTS, sizeof *hotspots);
        int target = 0;
        while (target < HOTSPOTS - 1 && hotspots[target].confirmed)
            target++;
        for (int i = 0; i < N; i++) {
            actions[2 * i] = toward(uavs[i], hotspots[target]);
            actions[2 * i + 1] = 1; /* highest pilot density: most sensing */
        }
        if (jcas_sim_step(sim, actions, 2 * N, &outcome) != JCAS_OK)
            return 1;
    }
    jcas_metrics metrics = {.struct_size = sizeof metrics};
    jcas_sim_get_metrics(sim, &metrics);
    printf("%u of %d hotspots confirmed in %u steps, %.3f kWh\n", metrics.confirmed, HOTSPOTS,
           metrics.steps, metrics.energy_kwh);
    jcas_sim_free(sim);
    return jcas_model_free(model);
}
