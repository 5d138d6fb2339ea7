/* Reading, saving, loading, forking. */
#include "abuse_common.h"

/* Checks a function that writes elements: every wrong argument, then the right ones. */
#define ABUSE_BUFFER(type, function, sim, count)                                                   \
    do {                                                                                           \
        size_t count_ = (count);                                                                   \
        type *buffer_ = ARRAY(type, count_ + 1);                                                   \
        mark(buffer_, sizeof(type) * (count_ + 1));                                                \
        EXPECT(JCAS_ERROR_NULL, function(NULL, buffer_, count_));                                  \
        EXPECT(JCAS_ERROR_NULL, function(sim, NULL, count_));                                      \
        EXPECT(JCAS_ERROR_NULL, function(sim, NULL, 0));                                           \
        EXPECT(JCAS_ERROR_LENGTH, function(sim, buffer_, 0));                                      \
        EXPECT(JCAS_ERROR_LENGTH, function(sim, buffer_, count_ - 1));                             \
        EXPECT(JCAS_ERROR_LENGTH, function(sim, buffer_, count_ + 1));                             \
        EXPECT(JCAS_ERROR_LENGTH, function(sim, buffer_, SIZE_MAX / 2));                           \
        EXPECT(JCAS_ERROR_HANDLE, function(FOREIGN(jcas_sim), buffer_, count_));                   \
        if (sizeof(type) > 1)                                                                      \
            EXPECT(JCAS_ERROR_ALIGNMENT, function(sim, ASKEW(type, buffer_), count_));             \
        CHECK(untouched(buffer_, sizeof(type) * (count_ + 1)));                                    \
        OK(function(sim, buffer_, count_));                                                        \
        CHECK(untouched(buffer_ + count_, sizeof(type)));                                          \
        free(buffer_);                                                                             \
    } while (0)

/* Checks a function that writes a struct. */
#define ABUSE_STRUCT(type, function, sim)                                                          \
    do {                                                                                           \
        type record_;                                                                              \
        mark(&record_, sizeof record_);                                                            \
        EXPECT(JCAS_ERROR_NULL, function(NULL, &record_));                                         \
        EXPECT(JCAS_ERROR_NULL, function(sim, NULL));                                              \
        EXPECT(JCAS_ERROR_HANDLE, function(FOREIGN(jcas_sim), &record_));                          \
        EXPECT(JCAS_ERROR_ALIGNMENT, function(sim, ASKEW(type, not_a_handle)));                    \
        EXPECT(JCAS_ERROR_STRUCT_SIZE, function(sim, &record_));                                   \
        CHECK(untouched(&record_, sizeof record_));                                                \
        record_.struct_size = sizeof record_;                                                      \
        OK(function(sim, &record_));                                                               \
        CHECK(record_.struct_size == sizeof record_);                                              \
    } while (0)

static int32_t get_uavs(const jcas_sim *sim, jcas_uav *uavs, size_t count)
{
    return jcas_sim_get_uavs(sim, uavs, count, sizeof *uavs);
}

static int32_t get_hotspots(const jcas_sim *sim, jcas_hotspot *hotspots, size_t count)
{
    return jcas_sim_get_hotspots(sim, hotspots, count, sizeof *hotspots);
}

void abuse_reading(struct subject *subject)
{
    jcas_sim *sim = subject->sim;
    const jcas_model_info *info = &subject->info;
    ABUSE_BUFFER(float, jcas_sim_observe, sim, (size_t)info->uav_count * info->observation_len);
    ABUSE_BUFFER(float, jcas_sim_observe_global, sim, info->global_len);
    ABUSE_BUFFER(double, jcas_sim_get_rewards, sim, info->reward_len);
    ABUSE_BUFFER(double, jcas_sim_uav_rewards, sim, info->uav_count);
    ABUSE_BUFFER(double, jcas_sim_uav_reward_components, sim,
                 (size_t)info->uav_count * info->reward_len);
    ABUSE_BUFFER(jcas_uav, get_uavs, sim, info->uav_count);
    ABUSE_BUFFER(jcas_hotspot, get_hotspots, sim, info->hotspot_count);
    ABUSE_BUFFER(uint8_t, jcas_sim_get_links, sim, info->uav_count * info->uav_count);
    ABUSE_BUFFER(uint8_t, jcas_sim_get_knowledge, sim, info->uav_count * info->hotspot_count);
    ABUSE_BUFFER(uint8_t, jcas_sim_get_detections, sim, info->uav_count * info->hotspot_count);
    ABUSE_BUFFER(double, jcas_sim_get_throughputs, sim, info->uav_count * info->uav_count);
    ABUSE_BUFFER(uint8_t, jcas_sim_get_visited, sim, info->grid_width * info->grid_height);
    ABUSE_BUFFER(uint8_t, jcas_sim_get_search_maps, sim,
                 (size_t)info->uav_count * info->grid_width * info->grid_height);
    ABUSE_BUFFER(uint8_t, jcas_sim_get_false_alarms, sim,
                 (size_t)info->uav_count * info->grid_width * info->grid_height);
    ABUSE_BUFFER(uint8_t, jcas_sim_get_false_confirmations, sim,
                 (size_t)info->grid_width * info->grid_height);
    ABUSE_BUFFER(uint8_t, jcas_sim_get_reports, sim,
                 (size_t)info->uav_count * info->grid_width * info->grid_height);
    ABUSE_STRUCT(jcas_episode, jcas_sim_get_episode, sim);
    ABUSE_STRUCT(jcas_metrics, jcas_sim_get_metrics, sim);

    jcas_uav uavs[4];
    jcas_hotspot hotspots[3];
    mark(uavs, sizeof uavs);
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_sim_get_uavs(sim, uavs, 4, sizeof *uavs - 8));
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_sim_get_hotspots(sim, hotspots, 3, sizeof *hotspots + 8));
    CHECK(untouched(uavs, sizeof uavs));

    /* The quantities agree with each other. */
    OK(jcas_sim_get_uavs(sim, uavs, 4, sizeof *uavs));
    uint8_t links[16];
    OK(jcas_sim_get_links(sim, links, 16));
    for (int i = 0; i < 4; i++) {
        unsigned degree = 0;
        for (int k = 0; k < 4; k++) {
            CHECK(links[4 * i + k] == links[4 * k + i]);
            degree += links[4 * i + k];
        }
        CHECK(degree == uavs[i].neighbours);
        CHECK(uavs[i].battery_uj == uavs[i].initial_uj + uavs[i].accepted_uj - uavs[i].spent_uj);
    }
}

/* Checks the fields of an observation: every wrong argument, then the place of the last entry. */
void abuse_observation_fields(struct subject *subject)
{
    const jcas_model *model = subject->model;
    jcas_observation_field fields[JCAS_OBSERVATION_FIELDS + 1];
    const size_t size = sizeof *fields, count = JCAS_OBSERVATION_FIELDS;
    mark(fields, sizeof fields);
    EXPECT(JCAS_ERROR_NULL, jcas_model_observation_fields(NULL, fields, count, size));
    EXPECT(JCAS_ERROR_NULL, jcas_model_observation_fields(model, NULL, count, size));
    EXPECT(JCAS_ERROR_LENGTH, jcas_model_observation_fields(model, fields, count - 1, size));
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_model_observation_fields(model, fields, count, size + 4));
    EXPECT(JCAS_ERROR_HANDLE,
           jcas_model_observation_fields(FOREIGN(jcas_model), fields, count, size));
    CHECK(untouched(fields, sizeof fields));
    OK(jcas_model_observation_fields(model, fields, count, size));
    CHECK(untouched(fields + count, size));
    size_t entries = 0;
    for (size_t k = 0; k < count; k++) {
        CHECK(jcas_observation_field_name((uint32_t)k) != NULL);
        entries += fields[k].count;
    }
    CHECK(entries == subject->info.observation_len);
    CHECK(strcmp(jcas_observation_field_name((uint32_t)count - 1), "report_level") == 0);
    const jcas_observation_field *last = &fields[count - 1];
    CHECK(last->offset + (last->count - 1) * last->stride == subject->info.observation_len - 1);
    CHECK(jcas_observation_field_name((uint32_t)count) == NULL);
}

static void expect_same(const jcas_sim *sim, uint64_t hash)
{
    uint64_t now;
    OK(jcas_sim_hash(sim, &now));
    CHECK(now == hash);
}

void abuse_snapshots(struct subject *subject)
{
    jcas_sim *sim = subject->sim;
    size_t size = subject->info.snapshot_size;
    unsigned char *saved = ARRAY(unsigned char, size + 1), *broken = ARRAY(unsigned char, size + 1);
    float actions[8] = {0.4f, 1, -0.4f, 1, 0, 0, 0, 0};
    jcas_outcome outcome;
    outcome.struct_size = sizeof outcome;
    uint64_t hash;
    OK(jcas_sim_reset(sim, 21));
    OK(jcas_sim_step(sim, actions, 8, &outcome));
    mark(saved, size + 1);
    EXPECT(JCAS_ERROR_NULL, jcas_sim_save(NULL, saved, size));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_save(sim, NULL, size));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_save(sim, saved, size - 1));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_save(sim, saved, size + 1));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_save(FOREIGN(jcas_sim), saved, size));
    CHECK(untouched(saved, size + 1));
    OK(jcas_sim_save(sim, saved, size));
    CHECK(untouched(saved + size, 1));

    OK(jcas_sim_step(sim, actions, 8, &outcome));
    OK(jcas_sim_hash(sim, &hash));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_load(NULL, saved, size));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_load(sim, NULL, size));
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_load(sim, saved, SIZE_MAX));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_load(FOREIGN(jcas_sim), saved, size));
    EXPECT(JCAS_ERROR_MODEL_MISMATCH, jcas_sim_load(subject->other_sim, saved, size));
    for (size_t cut = 0; cut < size; cut++)
        EXPECT(JCAS_ERROR_CORRUPT, jcas_sim_load(sim, saved, cut));
    EXPECT(JCAS_ERROR_CORRUPT, jcas_sim_load(sim, saved, size + 1));
    for (size_t at = 0; at < size; at++) {
        memcpy(broken, saved, size);
        broken[at] ^= (unsigned char)(1u << at % 8);
        int32_t status = jcas_sim_load(sim, broken, size);
        CHECK(status == JCAS_ERROR_CORRUPT ||
              (status == JCAS_ERROR_MODEL_MISMATCH && at >= 16 && at < 24));
    }
    expect_same(sim, hash);

    /* Any alignment is valid, and the episode continues unchanged. */
    memcpy(broken + 1, saved, size);
    OK(jcas_sim_load(sim, broken + 1, size));
    OK(jcas_sim_step(sim, actions, 8, &outcome));
    expect_same(sim, hash);

    jcas_sim *twin;
    OK(jcas_sim_new(subject->model, &twin));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_fork(NULL, twin));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_fork(sim, NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_fork(FOREIGN(jcas_sim), twin));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_fork(sim, FOREIGN(jcas_sim)));
    EXPECT(JCAS_ERROR_MODEL_MISMATCH, jcas_sim_fork(sim, subject->other_sim));
    OK(jcas_sim_fork(sim, sim));
    OK(jcas_sim_fork(sim, twin));
    expect_same(twin, hash);
    OK(jcas_sim_step(twin, actions, 8, &outcome));
    expect_same(sim, hash);
    OK(jcas_sim_free(twin));

    mark(&hash, sizeof hash);
    EXPECT(JCAS_ERROR_NULL, jcas_sim_hash(NULL, &hash));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_hash(sim, NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_hash(FOREIGN(jcas_sim), &hash));
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_sim_hash(sim, ASKEW(uint64_t, not_a_handle)));
    CHECK(untouched(&hash, sizeof hash));
    free(saved);
    free(broken);
}
