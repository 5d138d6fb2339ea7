/* Simulations: building, and stepping whole and by parts. */
#include "abuse_common.h"

static uint64_t hash_of(const jcas_sim *sim)
{
    uint64_t hash;
    OK(jcas_sim_hash(sim, &hash));
    return hash;
}

static void abuse_building(struct subject *subject)
{
    const jcas_model *model = subject->model;
    size_t size, alignment;
    mark(&size, sizeof size);
    mark(&alignment, sizeof alignment);
    EXPECT(JCAS_ERROR_NULL, jcas_sim_layout(NULL, &size, &alignment));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_layout(model, NULL, &alignment));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_layout(model, &size, NULL));
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_sim_layout(model, ASKEW(size_t, not_a_handle), &alignment));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_layout(FOREIGN(jcas_model), &size, &alignment));
    CHECK(untouched(&size, sizeof size) && untouched(&alignment, sizeof alignment));
    OK(jcas_sim_layout(model, &size, &alignment));

    jcas_sim *sim;
    mark(&sim, sizeof sim);
    unsigned char *memory = ARRAY(unsigned char, size + 1);
    mark(memory, size + 1);
    EXPECT(JCAS_ERROR_NULL, jcas_sim_init(NULL, size, model, &sim));
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_sim_init(memory + 1, size, model, &sim));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_init(memory, size - 1, model, &sim));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_init(memory, size, NULL, &sim));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_init(memory, size, model, NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_init(memory, size, FOREIGN(jcas_model), &sim));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_new(NULL, &sim));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_new(model, NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_new((const jcas_model *)(void *)subject->batch, &sim));
    CHECK(untouched(memory, size + 1) && untouched(&sim, sizeof sim));

    OK(jcas_sim_init(memory, size, model, &sim));
    CHECK(memory[size] == 0xa5);
    CHECK(hash_of(sim) == hash_of(subject->sim));
    unsigned char *copy = ARRAY(unsigned char, size);
    memcpy(copy, memory, size);
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_reset((jcas_sim *)(void *)copy, 1));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_free((jcas_sim *)(void *)copy));
    OK(jcas_sim_free(sim));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_free(sim));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_reset(sim, 1));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_free(FOREIGN(jcas_sim)));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_free((jcas_sim *)(void *)subject->model));
    free(copy);
    free(memory);
}

static void abuse_stepping(struct subject *subject)
{
    float actions[9] = {0};
    jcas_outcome outcome;
    mark(&outcome, sizeof outcome);
    outcome.struct_size = sizeof outcome;
    jcas_outcome kept = outcome;
    jcas_sim *sim = subject->sim;
    OK(jcas_sim_reset(sim, 3));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_reset(NULL, 3));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_reset(FOREIGN(jcas_sim), 3));
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_sim_reset(ASKEW(jcas_sim, sim), 3));
    uint64_t before = hash_of(sim);

    EXPECT(JCAS_ERROR_NULL, jcas_sim_step(NULL, actions, 8, &outcome));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_step(sim, NULL, 8, &outcome));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_step(sim, NULL, 0, &outcome));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_step(sim, actions, 8, NULL));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_step(sim, actions, 7, &outcome));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_step(sim, actions, 9, &outcome));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_step(sim, actions, SIZE_MAX, &outcome));
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_sim_step(sim, ASKEW(float, actions), 8, &outcome));
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_sim_step(sim, actions, 8, ASKEW(jcas_outcome, not_a_handle)));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_step(FOREIGN(jcas_sim), actions, 8, &outcome));
    EXPECT(JCAS_ERROR_HANDLE,
           jcas_sim_step((jcas_sim *)(void *)subject->batch, actions, 8, &outcome));
    actions[5] = NAN;
    EXPECT(JCAS_ERROR_NAN, jcas_sim_step(sim, actions, 8, &outcome));
    char text[128];
    size_t length;
    OK(jcas_sim_message(sim, text, sizeof text, &length));
    CHECK(strcmp(text, "actions[2][1] = NaN: must be a number (clipped to -1..1)") == 0);
    actions[5] = 0;
    CHECK(memcmp(&outcome, &kept, sizeof outcome) == 0);
    outcome.struct_size = 0;
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_sim_step(sim, actions, 8, &outcome));
    outcome.struct_size = sizeof outcome + 4;
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_sim_step(sim, actions, 8, &outcome));
    CHECK(hash_of(sim) == before);

    outcome.struct_size = sizeof outcome;
    for (int step = 0; step < 5; step++)
        OK(jcas_sim_step(sim, actions, 8, &outcome));
    CHECK(outcome.truncated == 1 && outcome.terminated == 0);
    before = hash_of(sim);
    kept = outcome;
    EXPECT(JCAS_ERROR_EPISODE_OVER, jcas_sim_step(sim, actions, 8, &outcome));
    EXPECT(JCAS_ERROR_EPISODE_OVER, jcas_sim_step_begin(sim, actions, 8));
    EXPECT(JCAS_ERROR_EPISODE_OVER, jcas_sim_step_end(sim, &outcome));
    CHECK(memcmp(&outcome, &kept, sizeof outcome) == 0 && hash_of(sim) == before);
}

void abuse_simulations(struct subject *subject)
{
    abuse_building(subject);
    abuse_stepping(subject);
    size_t length;
    EXPECT(JCAS_ERROR_NULL, jcas_sim_message(NULL, NULL, 0, &length));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_message(FOREIGN(jcas_sim), NULL, 0, &length));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_message(subject->sim, NULL, 0, NULL));
}

/* Calls the parts in each wrong order. */
static void abuse_order(jcas_sim *sim, const float *actions)
{
    jcas_outcome outcome;
    outcome.struct_size = sizeof outcome;
    uint8_t links[16] = {0};
    jcas_cell cells[4] = {{0, 0}, {0, 0}, {0, 0}, {0, 0}};
    for (int done = 0; done < 4; done++) {
        OK(jcas_sim_reset(sim, 9));
        if (done > 0)
            OK(jcas_sim_step_begin(sim, actions, 8));
        if (done > 1)
            OK(jcas_sim_step_sense(sim));
        if (done > 2)
            OK(jcas_sim_step_communicate(sim));
        uint64_t before = hash_of(sim);
        if (done != 0) {
            EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_step_begin(sim, actions, 8));
            EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_step(sim, actions, 8, &outcome));
        }
        if (done != 1) {
            EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_step_sense(sim));
            EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_set_positions(sim, cells, 4));
        }
        if (done != 2) {
            EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_step_communicate(sim));
            EXPECT(JCAS_ERROR_OUT_OF_ORDER,
                   jcas_sim_step_communicate_with(sim, links, 16, NULL, 0));
        }
        if (done != 3)
            EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_step_end(sim, &outcome));
        CHECK(hash_of(sim) == before);
    }
}

static void abuse_positions(jcas_sim *sim, const float *actions)
{
    jcas_cell cells[4] = {{0, 0}, {1, 1}, {12, 0}, {3, 3}};
    OK(jcas_sim_reset(sim, 9));
    OK(jcas_sim_step_begin(sim, actions, 8));
    uint64_t before = hash_of(sim);
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_set_positions(sim, cells, 4));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_set_positions(sim, cells, 3));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_set_positions(sim, NULL, 4));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_set_positions(NULL, cells, 4));
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_sim_set_positions(sim, ASKEW(jcas_cell, cells), 4));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_set_positions(FOREIGN(jcas_sim), cells, 4));
    CHECK(hash_of(sim) == before);
    cells[2].x = 11;
    OK(jcas_sim_set_positions(sim, cells, 4));
}

/* The simulation has to be between set_positions and step_sense. */
static void abuse_links(jcas_sim *sim)
{
    uint8_t links[16] = {0};
    double throughput[4] = {0, 1, 2, 3};
    links[1] = 1;
    OK(jcas_sim_step_sense(sim));
    uint64_t before = hash_of(sim);
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_step_communicate_with(sim, links, 16, throughput, 4));
    links[4] = 200;
    throughput[3] = NAN;
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_step_communicate_with(sim, links, 16, throughput, 4));
    throughput[3] = -1;
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_step_communicate_with(sim, links, 16, throughput, 4));
    throughput[3] = INFINITY;
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_step_communicate_with(sim, links, 16, throughput, 4));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_step_communicate_with(sim, links, 15, NULL, 0));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_step_communicate_with(sim, links, 16, throughput, 3));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_step_communicate_with(sim, NULL, 16, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_step_communicate_with(sim, links, 16, NULL, 4));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_step_communicate_with(NULL, links, 16, NULL, 0));
    EXPECT(JCAS_ERROR_HANDLE,
           jcas_sim_step_communicate_with(FOREIGN(jcas_sim), links, 16, NULL, 0));
    EXPECT(JCAS_ERROR_ALIGNMENT,
           jcas_sim_step_communicate_with(sim, links, 16, ASKEW(double, throughput), 4));
    CHECK(hash_of(sim) == before);
    OK(jcas_sim_step_communicate_with(sim, links, 16, NULL, 0));

    jcas_outcome outcome;
    mark(&outcome, sizeof outcome);
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_sim_step_end(sim, &outcome));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_step_end(sim, NULL));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_step_end(NULL, &outcome));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_step_end(FOREIGN(jcas_sim), &outcome));
    CHECK(untouched(&outcome, sizeof outcome));
    outcome.struct_size = sizeof outcome;
    OK(jcas_sim_step_end(sim, &outcome));
}

static void abuse_start(struct subject *subject, const float *actions)
{
    jcas_sim *sim = subject->sim;
    jcas_cell spots[3] = {{0, 0}, {1, 1}, {6, 6}};
    uint64_t charges[4] = {0, 1, 2, subject->info.battery_capacity_uj + 1};
    OK(jcas_sim_reset(sim, 9));
    uint64_t before = hash_of(sim);
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_set_hotspots(sim, spots, 3)); /* on the depot */
    spots[2].x = 0, spots[2].y = 0;
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_set_hotspots(sim, spots, 3)); /* twice */
    spots[2].x = 4000000000u;
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_set_hotspots(sim, spots, 3));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_set_hotspots(sim, spots, 2));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_set_hotspots(sim, NULL, 3));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_set_hotspots(NULL, spots, 3));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_set_hotspots(FOREIGN(jcas_sim), spots, 3));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_set_batteries(sim, charges, 4));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_set_batteries(sim, charges, 5));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_set_batteries(sim, NULL, 4));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_set_batteries(NULL, charges, 4));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_set_batteries(FOREIGN(jcas_sim), charges, 4));
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_sim_set_batteries(sim, ASKEW(uint64_t, charges), 4));
    CHECK(hash_of(sim) == before);
    charges[3] = 3;
    spots[2].x = 2;
    OK(jcas_sim_set_batteries(sim, charges, 4));
    OK(jcas_sim_set_hotspots(sim, spots, 3));
    jcas_outcome outcome;
    outcome.struct_size = sizeof outcome;
    OK(jcas_sim_step(sim, actions, 8, &outcome));
    before = hash_of(sim);
    EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_set_hotspots(sim, spots, 3));
    EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_set_batteries(sim, charges, 4));
    CHECK(hash_of(sim) == before);
}

/* The message is empty after a success, and otherwise that of the last failure. */
static void expect_message(const jcas_sim *sim, const char *words)
{
    char text[160];
    size_t length;
    OK(jcas_sim_message(sim, text, sizeof text, &length));
    if (strcmp(text, words) != 0)
        fprintf(stderr, "message: %s\n", text);
    CHECK(strcmp(text, words) == 0 && length == strlen(words));
}

static void abuse_hosting(jcas_sim *sim, const float *actions)
{
    jcas_cell starts[4] = {{0, 0}, {1, 1}, {2, 2}, {11, 11}}, off = {12, 0};
    uint8_t detections[12] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    jcas_outcome outcome = {.struct_size = sizeof outcome};
    jcas_uav uavs[4];
    EXPECT(JCAS_ERROR_NULL, jcas_sim_set_starts(NULL, starts, 4));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_set_starts(sim, NULL, 4));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_set_starts(sim, starts, 3));
    expect_message(sim, "a buffer has 3 elements: must have 4");
    starts[2] = off;
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_set_starts(sim, starts, 4));
    expect_message(sim, "starts = [12, 0]: must be cells of the grid");
    starts[2].x = 2;
    OK(jcas_sim_set_starts(sim, starts, 4));
    expect_message(sim, "");
    EXPECT(JCAS_ERROR_NULL, jcas_sim_set_battery(NULL, 0, 0));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_set_battery(sim, 4, 0));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_set_battery(sim, 0, UINT64_MAX));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_move_hotspot(NULL, 0, 0, 0));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_move_hotspot(sim, 3, 0, 0));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_move_hotspot(sim, 0, 6, 6));
    EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_ground(sim, 0));
    EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_confirm_hotspot(sim, 0));
    EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_step_sense_with(sim, detections, 12));
    OK(jcas_sim_set_battery(sim, 0, 1000));
    OK(jcas_sim_step_begin(sim, actions, 8));
    EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_set_battery(sim, 0, 0));
    EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_move_hotspot(sim, 0, 0, 0));
    EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_set_starts(sim, starts, 4));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_ground(NULL, 0));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_ground(sim, 4));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_confirm_hotspot(NULL, 0));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_confirm_hotspot(sim, 3));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_step_sense_with(NULL, detections, 12));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_step_sense_with(sim, NULL, 12));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_step_sense_with(sim, detections, 11));
    OK(jcas_sim_ground(sim, 3));
    OK(jcas_sim_step_sense_with(sim, detections, 12));
    OK(jcas_sim_get_detections(sim, detections, 12));
    CHECK(detections[0] == 1 && detections[8] == 1 && detections[9] == 0 && detections[11] == 0);
    OK(jcas_sim_step_communicate(sim));
    OK(jcas_sim_step_end(sim, &outcome));
    OK(jcas_sim_get_uavs(sim, uavs, 4, sizeof *uavs));
    CHECK(uavs[0].given_uj < 0 && uavs[3].grounded == 1 && uavs[3].moved == 0 &&
          uavs[3].spent_uj == 0);
    CHECK(uavs[0].battery_uj + uavs[0].spent_uj ==
          uavs[0].initial_uj + uavs[0].accepted_uj + (uint64_t)uavs[0].given_uj);
    CHECK(uavs[0].known == 3 && uavs[3].known == 0);
}

void abuse_parts(struct subject *subject)
{
    float actions[8] = {0};
    jcas_sim *sim = subject->sim;
    abuse_order(sim, actions);
    OK(jcas_sim_reset(sim, 9));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_step_begin(NULL, actions, 8));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_step_begin(sim, NULL, 8));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_step_begin(sim, actions, 1));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_step_begin(FOREIGN(jcas_sim), actions, 8));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_step_sense(NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_step_sense(FOREIGN(jcas_sim)));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_step_communicate(NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_step_communicate(FOREIGN(jcas_sim)));
    actions[0] = NAN;
    EXPECT(JCAS_ERROR_NAN, jcas_sim_step_begin(sim, actions, 8));
    actions[0] = INFINITY; /* clipped */
    abuse_hosting(sim, actions);
    OK(jcas_sim_reset(sim, 9));
    OK(jcas_sim_step_begin(sim, actions, 8));
    abuse_positions(sim, actions);
    abuse_links(sim);
    abuse_start(subject, actions);
}
