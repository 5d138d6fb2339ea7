/* Batches. */
#include "abuse_common.h"

/* Buffers of a batch step. */
struct buffers {
    float *observations, *finals, *global, *final_global, *actions;
    float rewards[ENVIRONMENTS], uav_rewards[ENVIRONMENTS * 4];
    double components[ENVIRONMENTS * 12];
    uint8_t terminated[ENVIRONMENTS], truncated[ENVIRONMENTS];
    jcas_metrics metrics[ENVIRONMENTS];
    size_t observed, shared, acted;
};

static void begin(struct buffers *buffers, jcas_batch_out *out, const jcas_model_info *info)
{
    memset(buffers, 0, sizeof *buffers);
    buffers->observed = (size_t)ENVIRONMENTS * info->uav_count * info->observation_len;
    buffers->shared = (size_t)ENVIRONMENTS * info->global_len;
    buffers->acted = (size_t)ENVIRONMENTS * info->action_len;
    buffers->observations = ARRAY(float, buffers->observed);
    buffers->finals = ARRAY(float, buffers->observed);
    buffers->global = ARRAY(float, buffers->shared);
    buffers->final_global = ARRAY(float, buffers->shared);
    buffers->actions = ARRAY(float, buffers->acted);
    memset(buffers->actions, 0, buffers->acted * sizeof(float));
    mark(buffers->observations, buffers->observed * sizeof(float));
    mark(buffers->finals, buffers->observed * sizeof(float));
    mark(buffers->global, buffers->shared * sizeof(float));
    mark(buffers->rewards, sizeof buffers->rewards);
    mark(buffers->metrics, sizeof buffers->metrics);
    memset(out, 0, sizeof *out);
    out->struct_size = sizeof *out;
    out->observations = buffers->observations, out->observation_count = buffers->observed;
    out->rewards = buffers->rewards, out->reward_count = ENVIRONMENTS;
    out->terminated = buffers->terminated, out->terminated_count = ENVIRONMENTS;
    out->truncated = buffers->truncated, out->truncated_count = ENVIRONMENTS;
    out->global = buffers->global, out->global_count = buffers->shared;
    out->components = buffers->components, out->component_count = ENVIRONMENTS * 12;
    out->final_observations = buffers->finals, out->final_observation_count = buffers->observed;
    out->final_global = buffers->final_global, out->final_global_count = buffers->shared;
    out->final_metrics = buffers->metrics, out->final_metrics_count = ENVIRONMENTS;
    out->metrics_size = sizeof(jcas_metrics);
    out->uav_rewards = buffers->uav_rewards, out->uav_reward_count = ENVIRONMENTS * 4;
}

static uint64_t hash_of(const struct subject *subject)
{
    uint64_t hash[ENVIRONMENTS];
    for (uint32_t m = 0; m < ENVIRONMENTS; m++) {
        OK(jcas_batch_get(subject->batch, m, subject->sim));
        OK(jcas_sim_hash(subject->sim, &hash[m]));
    }
    return hash[0] * 31 + hash[1];
}

static void abuse_building(const struct subject *subject)
{
    jcas_batch *batch;
    mark(&batch, sizeof batch);
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_batch_new(subject->model, 0, 1, &batch));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_new(NULL, 1, 1, &batch));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_new(subject->model, 1, 1, NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_new(FOREIGN(jcas_model), 1, 1, &batch));
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_free(FOREIGN(jcas_batch)));
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_free((jcas_batch *)(void *)subject->sim));
    CHECK(untouched(&batch, sizeof batch));
    /* A batch has no more threads than environments. */
    OK(jcas_batch_new(subject->model, 1, UINT32_MAX, &batch));
    OK(jcas_batch_free(batch));
}

static void abuse_resetting_some(const struct subject *subject, struct buffers *buffers)
{
    jcas_batch *batch = subject->batch;
    uint64_t seeds[ENVIRONMENTS] = {5, 6};
    uint8_t mask[ENVIRONMENTS] = {1, 1};
    float *seen = buffers->observations;
    size_t observed = buffers->observed;
    EXPECT(JCAS_ERROR_NULL,
           jcas_batch_reset_some(NULL, mask, 2, seeds, 2, seen, observed, NULL, 0));
    EXPECT(JCAS_ERROR_NULL,
           jcas_batch_reset_some(batch, NULL, 2, seeds, 2, seen, observed, NULL, 0));
    EXPECT(JCAS_ERROR_LENGTH,
           jcas_batch_reset_some(batch, mask, 1, seeds, 2, seen, observed, NULL, 0));
    EXPECT(JCAS_ERROR_LENGTH,
           jcas_batch_reset_some(batch, mask, 2, seeds, 1, seen, observed, NULL, 0));
    EXPECT(JCAS_ERROR_LENGTH, jcas_batch_reset_some(batch, mask, 2, seeds, 2, seen, 1, NULL, 0));
    EXPECT(JCAS_ERROR_ARGUMENT,
           jcas_batch_reset_some(batch, (uint8_t *)seeds, 2, seeds, 2, seen, observed, NULL, 0));
    EXPECT(JCAS_ERROR_HANDLE,
           jcas_batch_reset_some(FOREIGN(jcas_batch), mask, 2, seeds, 2, seen, observed, NULL, 0));
}

static void abuse_reset(const struct subject *subject, struct buffers *buffers)
{
    jcas_batch *batch = subject->batch;
    uint64_t seeds[ENVIRONMENTS + 1] = {5, 6, 7};
    float *observations = buffers->observations, *global = buffers->global;
    size_t observed = buffers->observed, shared = buffers->shared;
    uint64_t before = hash_of(subject);
    EXPECT(JCAS_ERROR_NULL, jcas_batch_reset(NULL, seeds, 2, observations, observed, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_reset(batch, NULL, 2, observations, observed, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_reset(batch, seeds, 2, NULL, observed, NULL, 0));
    EXPECT(JCAS_ERROR_NULL,
           jcas_batch_reset(batch, seeds, 2, observations, observed, NULL, shared));
    EXPECT(JCAS_ERROR_LENGTH, jcas_batch_reset(batch, seeds, 3, observations, observed, NULL, 0));
    EXPECT(JCAS_ERROR_LENGTH,
           jcas_batch_reset(batch, seeds, 2, observations, observed - 1, NULL, 0));
    EXPECT(JCAS_ERROR_LENGTH, jcas_batch_reset(batch, seeds, 2, observations, observed, global, 1));
    EXPECT(JCAS_ERROR_ARGUMENT,
           jcas_batch_reset(batch, seeds, 2, observations, observed, observations, shared));
    char text[128];
    size_t length;
    OK(jcas_batch_message(batch, text, sizeof text, &length));
    CHECK(strcmp(text, "global and observations overlap: buffers must lie apart") == 0);
    /* The length is checked first, for any address of the buffers. */
    EXPECT(JCAS_ERROR_LENGTH,
           jcas_batch_reset(batch, seeds, 2, observations, observed, observations, 1));
    abuse_resetting_some(subject, buffers);
    EXPECT(JCAS_ERROR_HANDLE,
           jcas_batch_reset(FOREIGN(jcas_batch), seeds, 2, observations, observed, NULL, 0));
    CHECK(untouched(observations, observed * sizeof(float)) &&
          untouched(global, shared * sizeof(float)));
    CHECK(hash_of(subject) == before);
    OK(jcas_batch_reset(batch, seeds, 2, observations, observed, global, shared));
    CHECK(hash_of(subject) != before);

    EXPECT(JCAS_ERROR_NULL, jcas_batch_observe(NULL, observations, observed, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_observe(batch, NULL, observed, NULL, 0));
    EXPECT(JCAS_ERROR_LENGTH, jcas_batch_observe(batch, observations, 1, NULL, 0));
    EXPECT(JCAS_ERROR_LENGTH, jcas_batch_observe(batch, observations, observed, global, 2));
    EXPECT(JCAS_ERROR_HANDLE,
           jcas_batch_observe(FOREIGN(jcas_batch), observations, observed, NULL, 0));
    uint64_t seen = hash_floats(observations, observed), seen_global = hash_floats(global, shared);
    OK(jcas_batch_observe(batch, observations, observed, global, shared));
    CHECK(seen == hash_floats(observations, observed) &&
          seen_global == hash_floats(global, shared));
}

/* Makes every field of the outputs wrong, one at a time. */
static void abuse_outputs(const struct subject *subject, struct buffers *buffers,
                          const jcas_batch_out *good)
{
    struct { int32_t status; jcas_batch_out out; } wrong[24];
    int count = 0;
#define WRONG(status_, field, value)                                                               \
    wrong[count].status = status_, wrong[count].out = *good, wrong[count++].out.field = value
    WRONG(JCAS_ERROR_STRUCT_SIZE, struct_size, 0);
    WRONG(JCAS_ERROR_ARGUMENT, reserved, 1);
    WRONG(JCAS_ERROR_NULL, observations, NULL);
    WRONG(JCAS_ERROR_LENGTH, observation_count, buffers->observed - 1);
    WRONG(JCAS_ERROR_NULL, rewards, NULL);
    WRONG(JCAS_ERROR_LENGTH, reward_count, 1);
    WRONG(JCAS_ERROR_ALIGNMENT, rewards, ASKEW(float, not_a_handle));
    WRONG(JCAS_ERROR_NULL, terminated, NULL);
    WRONG(JCAS_ERROR_LENGTH, terminated_count, 0);
    WRONG(JCAS_ERROR_NULL, truncated, NULL);
    WRONG(JCAS_ERROR_LENGTH, truncated_count, 1);
    WRONG(JCAS_ERROR_NULL, global, NULL);
    WRONG(JCAS_ERROR_LENGTH, global_count, buffers->shared + 1);
    WRONG(JCAS_ERROR_LENGTH, component_count, 12);
    WRONG(JCAS_ERROR_NULL, components, NULL);
    WRONG(JCAS_ERROR_LENGTH, final_observation_count, 0);
    WRONG(JCAS_ERROR_LENGTH, final_global_count, 1);
    WRONG(JCAS_ERROR_LENGTH, final_metrics_count, 1);
    WRONG(JCAS_ERROR_STRUCT_SIZE, metrics_size, sizeof(jcas_metrics) - 8);
    WRONG(JCAS_ERROR_LENGTH, uav_reward_count, ENVIRONMENTS);
    WRONG(JCAS_ERROR_ARGUMENT, uav_rewards, buffers->rewards);
    WRONG(JCAS_ERROR_ARGUMENT, final_observations, buffers->observations);
    WRONG(JCAS_ERROR_ARGUMENT, truncated, buffers->terminated + 1);
    WRONG(JCAS_ERROR_ARGUMENT, observations, buffers->actions);
#undef WRONG
    uint64_t before = hash_of(subject);
    struct buffers kept = *buffers;
    for (int i = 0; i < count; i++)
        EXPECT(wrong[i].status,
               jcas_batch_step(subject->batch, buffers->actions, buffers->acted, 1, &wrong[i].out));
    CHECK(hash_of(subject) == before);
    CHECK(memcmp(&kept, buffers, sizeof kept) == 0);
    CHECK(untouched(buffers->finals, buffers->observed * sizeof(float)));
}

/* An environment in the middle of a step refuses the batch step, and no environment steps. */
static void refuse_in_the_middle(const struct subject *subject, const struct buffers *buffers,
                                 const jcas_batch_out *out)
{
    jcas_batch *batch = subject->batch;
    struct buffers kept = *buffers;
    OK(jcas_batch_get(batch, 1, subject->sim));
    OK(jcas_sim_step_begin(subject->sim, buffers->actions, subject->info.action_len));
    OK(jcas_batch_set(batch, 1, subject->sim));
    uint64_t before = hash_of(subject);
    EXPECT(JCAS_ERROR_OUT_OF_ORDER,
           jcas_batch_step(batch, buffers->actions, buffers->acted, 1, out));
    CHECK(hash_of(subject) == before && memcmp(&kept, buffers, sizeof kept) == 0);
    OK(jcas_sim_reset(subject->sim, 6));
    OK(jcas_batch_set(batch, 1, subject->sim));
}

static void abuse_step(const struct subject *subject, struct buffers *buffers,
                       const jcas_batch_out *out)
{
    jcas_batch *batch = subject->batch;
    float *actions = buffers->actions;
    size_t acted = buffers->acted;
    uint64_t before = hash_of(subject);
    EXPECT(JCAS_ERROR_NULL, jcas_batch_step(NULL, actions, acted, 1, out));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_step(batch, NULL, acted, 1, out));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_step(batch, actions, acted, 1, NULL));
    EXPECT(JCAS_ERROR_LENGTH, jcas_batch_step(batch, actions, acted - 1, 1, out));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_batch_step(batch, actions, acted, 2, out));
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_step(FOREIGN(jcas_batch), actions, acted, 1, out));
    EXPECT(JCAS_ERROR_HANDLE,
           jcas_batch_step((jcas_batch *)(void *)subject->model, actions, acted, 1, out));
    actions[acted - 1] = NAN;
    EXPECT(JCAS_ERROR_NAN, jcas_batch_step(batch, actions, acted, 1, out));
    char text[128];
    size_t length;
    OK(jcas_batch_message(batch, text, sizeof text, &length));
    CHECK(strstr(text, "actions[7][1] = NaN") != NULL);
    EXPECT(JCAS_ERROR_NULL, jcas_batch_message(NULL, text, sizeof text, &length));
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_message(FOREIGN(jcas_batch), text, sizeof text, &length));
    actions[acted - 1] = 0;
    CHECK(hash_of(subject) == before && untouched(buffers->rewards, sizeof buffers->rewards));

    refuse_in_the_middle(subject, buffers, out);
    for (uint32_t step = 0; step < subject->config.horizon_steps; step++) {
        OK(jcas_batch_step(batch, actions, acted, 0, out));
        if (step == 0)
            refuse_in_the_middle(subject, buffers, out);
    }
    CHECK(buffers->truncated[0] == 1 && buffers->metrics[0].steps == subject->config.horizon_steps);
    CHECK(untouched(buffers->finals, buffers->observed * sizeof(float)));
    before = hash_of(subject);
    float reward = buffers->rewards[0];
    EXPECT(JCAS_ERROR_EPISODE_OVER, jcas_batch_step(batch, actions, acted, 0, out));
    EXPECT(JCAS_ERROR_EPISODE_OVER, jcas_batch_step(batch, actions, acted, 1, out));
    CHECK(hash_of(subject) == before && memcmp(&reward, &buffers->rewards[0], sizeof reward) == 0);
}

static void abuse_options(const struct subject *subject)
{
    jcas_batch_options options = {.struct_size = sizeof options, .environments = 2, .threads = 1};
    jcas_batch_options wrong = options;
    const jcas_model *model = subject->model;
    jcas_batch *batch;
    size_t size, alignment;
    mark(&size, sizeof size);
    EXPECT(JCAS_ERROR_NULL, jcas_batch_layout(NULL, &options, &size, &alignment));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_layout(model, NULL, &size, &alignment));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_layout(model, &options, NULL, &alignment));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_layout(model, &options, &size, NULL));
    wrong.reserved = 1;
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_batch_layout(model, &wrong, &size, &alignment));
    wrong.reserved = 0, wrong.environments = 0;
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_batch_layout(model, &wrong, &size, &alignment));
    wrong.struct_size = 8;
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_batch_layout(model, &wrong, &size, &alignment));
    CHECK(untouched(&size, sizeof size));
    OK(jcas_batch_layout(model, &options, &size, &alignment));
    unsigned char *memory = ARRAY(unsigned char, size + 1);
    mark(memory, size + 1);
    EXPECT(JCAS_ERROR_NULL, jcas_batch_init(NULL, size, model, &options, &batch));
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_batch_init(memory + 1, size, model, &options, &batch));
    EXPECT(JCAS_ERROR_LENGTH, jcas_batch_init(memory, size - 1, model, &options, &batch));
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_init(memory, size, FOREIGN(jcas_model), &options, &batch));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_init(memory, size, model, &options, NULL));
    CHECK(untouched(memory, size + 1));
    OK(jcas_batch_init(memory, size, model, &options, &batch));
    CHECK(untouched(memory + size, 1));
    OK(jcas_batch_free(batch));
    free(memory);
}

static void abuse_saving(const struct subject *subject)
{
    jcas_batch *batch = subject->batch;
    size_t size = ENVIRONMENTS * subject->info.snapshot_size;
    unsigned char *saved = ARRAY(unsigned char, size);
    uint64_t hash;
    mark(saved, size);
    mark(&hash, sizeof hash);
    EXPECT(JCAS_ERROR_NULL, jcas_batch_save(NULL, saved, size));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_save(batch, NULL, size));
    EXPECT(JCAS_ERROR_LENGTH, jcas_batch_save(batch, saved, size - 1));
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_save(FOREIGN(jcas_batch), saved, size));
    CHECK(untouched(saved, size));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_load(batch, NULL, size));
    EXPECT(JCAS_ERROR_LENGTH, jcas_batch_load(batch, saved, size - 8));
    EXPECT(JCAS_ERROR_CORRUPT, jcas_batch_load(batch, saved, size));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_hash(NULL, &hash));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_hash(batch, NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_hash(FOREIGN(jcas_batch), &hash));
    CHECK(untouched(&hash, sizeof hash));
    free(saved);
}

static void abuse_members(const struct subject *subject)
{
    jcas_batch *batch = subject->batch;
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_batch_get(batch, ENVIRONMENTS, subject->sim));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_batch_set(batch, UINT32_MAX, subject->sim));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_get(NULL, 0, subject->sim));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_get(batch, 0, NULL));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_set(NULL, 0, subject->sim));
    EXPECT(JCAS_ERROR_NULL, jcas_batch_set(batch, 0, NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_get(FOREIGN(jcas_batch), 0, subject->sim));
    EXPECT(JCAS_ERROR_HANDLE, jcas_batch_set(batch, 0, FOREIGN(jcas_sim)));
    EXPECT(JCAS_ERROR_MODEL_MISMATCH, jcas_batch_get(batch, 0, subject->other_sim));
    EXPECT(JCAS_ERROR_MODEL_MISMATCH, jcas_batch_set(batch, 0, subject->other_sim));
}

void abuse_batches(struct subject *subject)
{
    struct buffers buffers;
    jcas_batch_out out;
    begin(&buffers, &out, &subject->info);
    abuse_building(subject);
    abuse_members(subject);
    abuse_options(subject);
    abuse_saving(subject);
    abuse_reset(subject, &buffers);
    abuse_outputs(subject, &buffers, &out);
    abuse_step(subject, &buffers, &out);
    free(buffers.observations);
    free(buffers.finals);
    free(buffers.global);
    free(buffers.final_global);
    free(buffers.actions);
}
