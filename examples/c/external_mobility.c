/* A host that owns motion and radio. It moves the UAVs on its own continuous map and supplies the
 * links. The kernel does sensing, knowledge, energy, carbon and reward. Nothing is allocated:
 * model, simulation and recording live in static arenas.
 *
 * With jcas installed and PKG_CONFIG_PATH set, as docs/c.md says:
 *
 *   libdir=$(pkg-config --variable=libdir jcas)
 *   cc external_mobility.c $(pkg-config --cflags --libs jcas) -lm -Wl,-rpath,"$libdir" && ./a.out
 *
 * With a file name, the mission is recorded there together with the host's values:
 *
 *   ./a.out flight.jsonl && jcas trace verify flight.jsonl
 *   jcas replay flight.jsonl -o flight.html
 */
#include <jcas.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { N = 8, HOTSPOTS = 3 };
static const double CELL_M = 50, SPEED_M_PER_STEP = 45, RADIO_RANGE_M = 130;

static _Alignas(16) unsigned char model_arena[64 * 1024], sim_arena[64 * 1024],
    trace_arena[64 * 1024];

struct aircraft {
    double x_m, y_m;
};

static void stop_on(int32_t status, const char *what)
{
    if (status != JCAS_OK) {
        fprintf(stderr, "%s: %s\n", what, jcas_status_string(status));
        exit(1);
    }
}

/* The host's flight model moves a UAV straight to the middle of a cell, at most one side a step. */
static void fly(struct aircraft *aircraft, jcas_hotspot target)
{
    double dx = (target.x + 0.5) * CELL_M - aircraft->x_m;
    double dy = (target.y + 0.5) * CELL_M - aircraft->y_m;
    double distance = hypot(dx, dy);
    double part = distance > SPEED_M_PER_STEP ? SPEED_M_PER_STEP / distance : 1;
    aircraft->x_m += part * dx;
    aircraft->y_m += part * dy;
}

/* The host's radio links each pair of UAVs in range. */
static void link_up(const struct aircraft *fleet, uint8_t *links)
{
    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) {
            double distance = hypot(fleet[i].x_m - fleet[k].x_m, fleet[i].y_m - fleet[k].y_m);
            links[N * i + k] = i != k && distance <= RADIO_RANGE_M;
        }
}

static int32_t write_trace(const char *bytes, size_t count, void *file)
{
    return fwrite(bytes, 1, count, file) == count ? 0 : 1;
}

int main(int argc, char **argv)
{
    FILE *file = argc > 1 ? fopen(argv[1], "wb") : NULL;
    if (argc > 1 && file == NULL) {
        perror(argv[1]);
        return 1;
    }
    jcas_config config;
    jcas_model *model;
    jcas_sim *sim;
    stop_on(jcas_config_default(&config, sizeof config), "configuration");
    config.uav_count = N;
    config.hotspot_count = HOTSPOTS;
    config.cell_size_m = CELL_M;
    stop_on(jcas_model_init(model_arena, sizeof model_arena, &config, &model, NULL, 0), "model");
    stop_on(jcas_sim_init(sim_arena, sizeof sim_arena, model, &sim), "simulation");
    jcas_recorder recorder = {.struct_size = sizeof recorder,
                              .write = write_trace,
                              .write_context = file,
                              .policy = "external mobility",
                              .memory = trace_arena,
                              .memory_size = sizeof trace_arena};
    stop_on(file ? jcas_sim_record(sim, 7, &recorder) : jcas_sim_reset(sim, 7), "reset");

    jcas_uav uavs[N];
    struct aircraft fleet[N];
    stop_on(jcas_sim_get_uavs(sim, uavs, N, sizeof *uavs), "UAVs");
    for (int i = 0; i < N; i++) {
        fleet[i].x_m = (uavs[i].x + 0.5) * CELL_M;
        fleet[i].y_m = (uavs[i].y + 0.5) * CELL_M;
    }

    jcas_outcome outcome = {.struct_size = sizeof outcome};
    while (!outcome.terminated && !outcome.truncated) {
        jcas_hotspot hotspots[HOTSPOTS];
        jcas_cell cells[N];
        uint8_t links[N * N];
        float actions[2 * N];
        stop_on(jcas_sim_get_hotspots(sim, hotspots, HOTSPOTS, sizeof *hotspots), "hotspots");
        int target = 0;
        while (target < HOTSPOTS - 1 && hotspots[target].confirmed)
            target++;
        for (int i = 0; i < N; i++) {
            fly(&fleet[i], hotspots[target]);
            cells[i].x = (uint32_t)(fleet[i].x_m / CELL_M);
            cells[i].y = (uint32_t)(fleet[i].y_m / CELL_M);
            actions[2 * i] = JCAS_MOVE_STAY; /* the host moves */
            actions[2 * i + 1] = 1;
        }
        link_up(fleet, links);
        stop_on(jcas_sim_step_begin(sim, actions, 2 * N), "actions");
        stop_on(jcas_sim_set_positions(sim, cells, N), "positions");
        stop_on(jcas_sim_step_sense(sim), "sensing");
        stop_on(jcas_sim_step_communicate_with(sim, links, N * N, NULL, 0), "communication");
        stop_on(jcas_sim_step_end(sim, &outcome), "end of step");
    }

    if (file) {
        stop_on(jcas_sim_record_end(sim), "end of recording");
        if (fclose(file) != 0) {
            perror(argv[1]);
            return 1;
        }
    }

    jcas_metrics metrics = {.struct_size = sizeof metrics};
    stop_on(jcas_sim_get_metrics(sim, &metrics), "metrics");
    printf("%s after %u steps: %u of %d hotspots confirmed, %u known to all, %llu moves, "
           "%.3f kWh\n",
           metrics.terminated ? "complete" : "at the horizon", metrics.steps, metrics.confirmed,
           HOTSPOTS, metrics.informed, (unsigned long long)metrics.moves, metrics.energy_kwh);
    stop_on(jcas_sim_free(sim), "end of simulation");
    stop_on(jcas_model_free(model), "end of model");
    return 0;
}
