/* Plans through the C interface, and the refusal of every wrong call.
 *
 * The program prints the hash of the last state of each mission: of a search, of a tour, and of the
 * policies `plan` and `replan`. */
#include "check.h"

#include <inttypes.h>

enum { UAVS = 5, HOTSPOTS = 2, SIDE = 7, ACTIONS = 2 * UAVS, MEMBERS = 2 };
enum { SEED = 4, ITERATIONS = 2000 };
enum { STEPS_MAX = 512, CELLS_MAX = UAVS * (STEPS_MAX + 1) };

static uint64_t not_a_handle[4096];
#define FOREIGN(type) ((type *)(void *)not_a_handle)
#define ASKEW(type, pointer) ((type *)(void *)((char *)(pointer) + 1))

static jcas_cell cells[CELLS_MAX];
static double densities[CELLS_MAX];
static const jcas_cell HOTSPOT_CELLS[HOTSPOTS] = {{0, 1}, {6, 5}};

static jcas_model *build(uint32_t uavs, int32_t visibility)
{
    jcas_config config;
    jcas_model *model;
    OK(jcas_config_default(&config, sizeof config));
    config.uav_count = uavs;
    config.hotspot_count = HOTSPOTS;
    config.grid_width = SIDE;
    config.grid_height = SIDE;
    config.target_visibility = visibility;
    OK(jcas_model_new(&config, &model, NULL, 0));
    return model;
}

static jcas_plan_settings settings(void)
{
    jcas_plan_settings settings;
    memset(&settings, 0, sizeof settings);
    settings.struct_size = sizeof settings;
    settings.iterations = ITERATIONS;
    settings.seed = 7;
    return settings;
}

static jcas_plan_info info_of(const jcas_plan *plan)
{
    jcas_plan_info info;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    OK(jcas_plan_get_info(plan, &info));
    return info;
}

static char *json_of(const jcas_plan *plan, size_t *length)
{
    OK(jcas_plan_to_json(plan, NULL, 0, length));
    char *text = ARRAY(char, *length + 1);
    OK(jcas_plan_to_json(plan, text, *length + 1, length));
    return text;
}

static void fly(jcas_policy *policy, jcas_sim *sim, const jcas_cell *hotspots)
{
    float actions[ACTIONS];
    uint64_t hash;
    jcas_outcome outcome;
    memset(&outcome, 0, sizeof outcome);
    outcome.struct_size = sizeof outcome;
    OK(jcas_sim_reset(sim, SEED));
    if (hotspots != NULL)
        OK(jcas_sim_set_hotspots(sim, hotspots, HOTSPOTS));
    while (!outcome.terminated && !outcome.truncated) {
        OK(jcas_policy_act(policy, sim, actions, ACTIONS));
        OK(jcas_sim_step(sim, actions, ACTIONS, &outcome));
    }
    OK(jcas_sim_hash(sim, &hash));
    printf("0x%016" PRIx64 "\n", hash);
}

static int32_t end_early(uint64_t iterations, double best_steps, void *context)
{
    CHECK(iterations > 0 && best_steps > 0);
    *(uint64_t *)context = iterations;
    return iterations >= 512;
}

/* The trajectories are legal, and the figures fit each other. */
static void read_plan(const jcas_model *model, const jcas_plan *plan)
{
    jcas_config config;
    OK(jcas_model_get_config(model, &config, sizeof config));
    jcas_plan_info info = info_of(plan);
    uint64_t hash;
    OK(jcas_config_hash(&config, &hash));
    CHECK(info.config_hash == hash && info.uav_count == UAVS && info.seed == 7);
    CHECK(info.step_count == config.horizon_steps && info.step_count <= STEPS_MAX);
    CHECK(0 < info.bound_steps && info.bound_steps <= info.expected_steps);
    CHECK(info.expected_confirmed_steps <= info.expected_steps);
    CHECK(info.expected_steps <= info.start_steps && 0 < info.success && info.success <= 1);
    const size_t looks = (size_t)UAVS * info.step_count, places = looks + UAVS;
    OK(jcas_plan_get_cells(plan, cells, places));
    OK(jcas_plan_get_pilot_densities(plan, densities, looks));
    for (size_t k = 0; k < places; k++) {
        CHECK(cells[k].x < SIDE && cells[k].y < SIDE);
        if (k % (info.step_count + 1) == 0) {
            CHECK(cells[k].x == SIDE / 2 && cells[k].y == SIDE / 2); /* the depot */
            continue;
        }
        int dx = (int)cells[k].x - (int)cells[k - 1].x, dy = (int)cells[k].y - (int)cells[k - 1].y;
        CHECK(abs(dx) + abs(dy) <= 1);
    }
    for (size_t k = 0; k < looks; k++)
        CHECK(config.pilot_density_min <= densities[k] && densities[k] <= config.pilot_density_max);
}

/* A plan from its own text is the same plan. */
static void keep(const jcas_model *model, const jcas_plan *plan)
{
    size_t length, again;
    char *text = json_of(plan, &length);
    jcas_plan *read;
    OK(jcas_plan_from_json(model, text, length, &read, NULL, 0));
    char *other = json_of(read, &again);
    CHECK(length == again && memcmp(text, other, length) == 0);
    const jcas_plan_info one = info_of(plan), two = info_of(read);
    CHECK(one.expected_steps == two.expected_steps && one.config_hash == two.config_hash);
    OK(jcas_plan_free(read));
    free(text);
    free(other);
}

static void abuse_making(const jcas_model *model)
{
    jcas_plan *plan = FOREIGN(jcas_plan);
    jcas_plan_settings given = settings(), small = given, reserved = given;
    jcas_cell off[HOTSPOTS] = {{0, 1}, {SIDE, 0}};
    char why[128] = "";
    small.struct_size -= 1;
    reserved.reserved = 1;
    EXPECT(JCAS_ERROR_NULL, jcas_plan_search(NULL, &given, &plan, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_plan_search(model, NULL, &plan, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_plan_search(model, &given, NULL, NULL, 0));
    EXPECT(JCAS_ERROR_HANDLE, jcas_plan_search(FOREIGN(jcas_model), &given, &plan, NULL, 0));
    const jcas_plan_settings *askew = ASKEW(jcas_plan_settings, &given);
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_plan_search(model, askew, &plan, NULL, 0));
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_plan_search(model, &small, &plan, NULL, 0));
    EXPECT(JCAS_ERROR_ARGUMENT,
           jcas_plan_search(model, &reserved, &plan, why, sizeof why));
    CHECK(strcmp(why, "reserved = 1: must be 0") == 0);
    EXPECT(JCAS_ERROR_NULL, jcas_plan_tour(NULL, HOTSPOT_CELLS, HOTSPOTS, &given, &plan, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_plan_tour(model, NULL, HOTSPOTS, &given, &plan, NULL, 0));
    EXPECT(JCAS_ERROR_LENGTH, jcas_plan_tour(model, HOTSPOT_CELLS, 1, &given, &plan, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_plan_tour(model, HOTSPOT_CELLS, HOTSPOTS, NULL, &plan, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_plan_tour(model, HOTSPOT_CELLS, HOTSPOTS, &given, NULL, NULL, 0));
    EXPECT(JCAS_ERROR_ARGUMENT,
           jcas_plan_tour(model, off, HOTSPOTS, &given, &plan, why, sizeof why));
    CHECK(strstr(why, "off the grid") != NULL);
    jcas_model *large = build(129, JCAS_VISIBILITY_HIDDEN);
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_plan_search(large, &given, &plan, why, sizeof why));
    CHECK(strstr(why, "at most 128") != NULL);
    jcas_policy *policy = FOREIGN(jcas_policy);
    why[0] = 0;
    EXPECT(JCAS_ERROR_ARGUMENT,
           jcas_policy_baseline(large, "replan", NULL, &policy, why, sizeof why));
    CHECK(strstr(why, "at most 128") != NULL && policy == FOREIGN(jcas_policy));
    OK(jcas_model_free(large));
    CHECK(plan == FOREIGN(jcas_plan));
}

static void abuse_texts(const jcas_model *model, const jcas_plan *plan)
{
    jcas_plan *read = FOREIGN(jcas_plan);
    size_t length, told = 7;
    char *text = json_of(plan, &length), why[128] = "";
    for (size_t end = 0; end < length; end += 1 + end / 3) {
        EXPECT(JCAS_ERROR_CORRUPT, jcas_plan_from_json(model, text, end, &read, why, sizeof why));
        CHECK(strstr(why, "no plan") != NULL);
    }
    EXPECT(JCAS_ERROR_CORRUPT, jcas_plan_from_json(model, "\xff", 1, &read, why, sizeof why));
    CHECK(strstr(why, "UTF-8") != NULL);
    EXPECT(JCAS_ERROR_NULL, jcas_plan_from_json(NULL, text, length, &read, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_plan_from_json(model, NULL, length, &read, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_plan_from_json(model, text, length, NULL, NULL, 0));
    EXPECT(JCAS_ERROR_LENGTH, jcas_plan_from_json(model, text, SIZE_MAX, &read, NULL, 0));
    jcas_model *other = build(UAVS + 1, JCAS_VISIBILITY_HIDDEN);
    jcas_policy *policy = FOREIGN(jcas_policy);
    EXPECT(JCAS_ERROR_MODEL_MISMATCH,
           jcas_plan_from_json(other, text, length, &read, why, sizeof why));
    CHECK(strstr(why, "configuration") != NULL);
    EXPECT(JCAS_ERROR_MODEL_MISMATCH, jcas_policy_follow(other, plan, &policy));
    OK(jcas_model_free(other));
    CHECK(read == FOREIGN(jcas_plan) && policy == FOREIGN(jcas_policy));
    mark(text, length + 1);
    EXPECT(JCAS_ERROR_LENGTH, jcas_plan_to_json(plan, text, length, &told));
    CHECK(told == length && untouched(text, length + 1));
    EXPECT(JCAS_ERROR_NULL, jcas_plan_to_json(NULL, text, length + 1, &told));
    EXPECT(JCAS_ERROR_NULL, jcas_plan_to_json(plan, NULL, length + 1, &told));
    EXPECT(JCAS_ERROR_NULL, jcas_plan_to_json(plan, text, length + 1, NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_plan_to_json(FOREIGN(jcas_plan), text, length + 1, &told));
    CHECK(untouched(text, length + 1));
    free(text);
}

static void abuse_reading(const jcas_model *model, jcas_plan *plan)
{
    jcas_plan_info info = info_of(plan), small = info;
    const size_t looks = (size_t)UAVS * info.step_count, places = looks + UAVS;
    jcas_policy *policy = FOREIGN(jcas_policy);
    small.struct_size = 8;
    EXPECT(JCAS_ERROR_NULL, jcas_plan_get_info(NULL, &info));
    EXPECT(JCAS_ERROR_NULL, jcas_plan_get_info(plan, NULL));
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_plan_get_info(plan, &small));
    EXPECT(JCAS_ERROR_HANDLE, jcas_plan_get_info(FOREIGN(jcas_plan), &info));
    EXPECT(JCAS_ERROR_HANDLE, jcas_plan_get_info((const jcas_plan *)(const void *)model, &info));
    mark(cells, sizeof cells);
    mark(densities, sizeof densities);
    EXPECT(JCAS_ERROR_NULL, jcas_plan_get_cells(NULL, cells, places));
    EXPECT(JCAS_ERROR_NULL, jcas_plan_get_cells(plan, NULL, places));
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_plan_get_cells(plan, ASKEW(jcas_cell, cells), places));
    EXPECT(JCAS_ERROR_LENGTH, jcas_plan_get_cells(plan, cells, places - 1));
    EXPECT(JCAS_ERROR_NULL, jcas_plan_get_pilot_densities(NULL, densities, looks));
    EXPECT(JCAS_ERROR_NULL, jcas_plan_get_pilot_densities(plan, NULL, looks));
    EXPECT(JCAS_ERROR_LENGTH, jcas_plan_get_pilot_densities(plan, densities, looks + 1));
    CHECK(untouched(cells, sizeof cells) && untouched(densities, sizeof densities));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_follow(NULL, plan, &policy));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_follow(model, NULL, &policy));
    EXPECT(JCAS_ERROR_NULL, jcas_policy_follow(model, plan, NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_policy_follow(model, FOREIGN(jcas_plan), &policy));
    CHECK(policy == FOREIGN(jcas_policy));
    EXPECT(JCAS_ERROR_HANDLE, jcas_plan_free(FOREIGN(jcas_plan)));
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_plan_free(ASKEW(jcas_plan, plan)));
    OK(jcas_plan_free(NULL));
}

/* Every member of a batch and a single simulation get the same actions. */
static void same_everywhere(jcas_model *model, jcas_sim *sim, jcas_policy *policy)
{
    static const uint64_t SEEDS[MEMBERS] = {11, 12};
    float one[ACTIONS], all[MEMBERS * ACTIONS];
    jcas_batch *batch;
    jcas_model_info info;
    memset(&info, 0, sizeof info);
    info.struct_size = sizeof info;
    OK(jcas_model_get_info(model, &info));
    size_t observed = (size_t)MEMBERS * info.uav_count * info.observation_len;
    float *observations = ARRAY(float, observed);
    OK(jcas_batch_new(model, MEMBERS, 1, &batch));
    OK(jcas_batch_reset(batch, SEEDS, MEMBERS, observations, observed, NULL, 0));
    OK(jcas_policy_act_batch(policy, batch, all, MEMBERS * ACTIONS));
    for (uint32_t member = 0; member < MEMBERS; member++) {
        OK(jcas_batch_get(batch, member, sim));
        OK(jcas_policy_act(policy, sim, one, ACTIONS));
        CHECK(memcmp(one, all + member * ACTIONS, sizeof one) == 0);
    }
    OK(jcas_batch_free(batch));
    free(observations);
}

static void search_hidden(void)
{
    jcas_model *model = build(UAVS, JCAS_VISIBILITY_HIDDEN);
    jcas_plan_settings given = settings();
    jcas_plan *plan, *short_plan;
    jcas_policy *policy;
    jcas_sim *sim;
    uint64_t heard = 0;
    OK(jcas_sim_new(model, &sim));
    abuse_making(model);
    OK(jcas_plan_search(model, &given, &plan, NULL, 0));
    CHECK(info_of(plan).stopped == 0 && info_of(plan).iterations == ITERATIONS);
    given.progress = end_early;
    given.progress_context = &heard;
    OK(jcas_plan_search(model, &given, &short_plan, NULL, 0));
    CHECK(info_of(short_plan).stopped == 1 && heard < ITERATIONS);
    CHECK(info_of(short_plan).iterations == heard);
    OK(jcas_plan_free(short_plan));
    read_plan(model, plan);
    keep(model, plan);
    abuse_texts(model, plan);
    abuse_reading(model, plan);
    OK(jcas_policy_follow(model, plan, &policy));
    OK(jcas_plan_free(plan)); /* the policy has its own */
    same_everywhere(model, sim, policy);
    fly(policy, sim, NULL);
    OK(jcas_policy_free(policy));
    OK(jcas_sim_free(sim));
    OK(jcas_model_free(model));
}

static void tour_known(void)
{
    jcas_model *model = build(UAVS, JCAS_VISIBILITY_KNOWN);
    jcas_plan_settings given = settings();
    jcas_plan *plan;
    jcas_policy *policy;
    jcas_sim *sim;
    OK(jcas_sim_new(model, &sim));
    OK(jcas_plan_tour(model, HOTSPOT_CELLS, HOTSPOTS, &given, &plan, NULL, 0));
    read_plan(model, plan);
    keep(model, plan);
    OK(jcas_policy_follow(model, plan, &policy));
    OK(jcas_plan_free(plan));
    fly(policy, sim, HOTSPOT_CELLS);
    OK(jcas_policy_free(policy));
    for (int k = 0; k < 2; k++) {
        const char *name = k == 0 ? "plan" : "replan";
        EXPECT(JCAS_ERROR_ARGUMENT, jcas_policy_baseline(model, name, "2", &policy, NULL, 0));
        OK(jcas_policy_baseline(model, name, NULL, &policy, NULL, 0));
        same_everywhere(model, sim, policy);
        fly(policy, sim, NULL);
        OK(jcas_policy_free(policy));
    }
    OK(jcas_sim_free(sim));
    OK(jcas_model_free(model));
}

int main(void)
{
    search_hidden();
    tour_known();
    return 0;
}
