/* Replays golden traces through the ABI and checks the hash of every state and observation. It
 * steps whole, by parts in the caller's memory, after a save and load, and in a batch.
 *
 *   replay TRACE... */
#include "check.h"

#include <inttypes.h>

/* One trace, replayed in four ways at once. */
struct flight {
    jcas_model *model;
    jcas_model_info info;
    jcas_sim *whole, *parts, *twin;
    void *parts_memory;
    jcas_batch *batch;
    float *actions, *observations, *others;
    unsigned char *snapshot;
    size_t observation_count;
    uint64_t steps;
};

static char *read_line(FILE *file)
{
    size_t size = 1 << 16, length = 0;
    char *line = ARRAY(char, size);
    while (fgets(line + length, (int)(size - length), file) != NULL) {
        length += strlen(line + length);
        if (length > 0 && line[length - 1] == '\n')
            return line;
        size *= 2;
        line = (char *)realloc(line, size);
        CHECK(line != NULL);
    }
    free(line);
    return NULL;
}

/* Returns the text behind "key": in a line of the trace. */
static char *value_of(char *line, const char *key)
{
    char pattern[64];
    int length = snprintf(pattern, sizeof pattern, "\"%s\":", key);
    char *found = strstr(line, pattern);
    CHECK(found != NULL);
    return found + length;
}

static uint64_t hex_of(char *line, const char *key)
{
    char *text = value_of(line, key);
    CHECK(strncmp(text, "\"0x", 3) == 0);
    return strtoull(text + 3, NULL, 16);
}

static void read_actions(char *line, float *actions, size_t count)
{
    char *at = value_of(line, "actions");
    for (size_t i = 0; i < count; i++) {
        at += strspn(at, "[], ");
        char *end;
        actions[i] = strtof(at, &end);
        CHECK(end != at);
        at = end;
    }
}

static void begin(struct flight *flight, char *header)
{
    char *text = value_of(header, "config");
    size_t length = strcspn(text, "}") + 1;
    jcas_config config;
    char message[512] = "";
    OK(jcas_config_from_json(text, length, &config, sizeof config, message, sizeof message));
    OK(jcas_model_new(&config, &flight->model, message, sizeof message));
    flight->info.struct_size = sizeof flight->info;
    OK(jcas_model_get_info(flight->model, &flight->info));
    CHECK(flight->info.config_hash == hex_of(header, "config_hash"));

    size_t size, alignment;
    OK(jcas_sim_layout(flight->model, &size, &alignment));
    CHECK(alignment <= sizeof(max_align_t));
    flight->parts_memory = allocated(size);
    OK(jcas_sim_init(flight->parts_memory, size, flight->model, &flight->parts));
    OK(jcas_sim_new(flight->model, &flight->whole));
    OK(jcas_sim_new(flight->model, &flight->twin));
    OK(jcas_batch_new(flight->model, 3, 2, &flight->batch));

    flight->observation_count = (size_t)flight->info.uav_count * flight->info.observation_len;
    flight->actions = ARRAY(float, 3 * flight->info.action_len);
    flight->observations = ARRAY(float, flight->observation_count);
    flight->others = ARRAY(float, 3 * flight->observation_count);
    flight->snapshot = ARRAY(unsigned char, flight->info.snapshot_size);

    uint64_t seed = hex_of(header, "seed");
    uint64_t seeds[3] = {seed, seed, seed};
    OK(jcas_sim_reset(flight->whole, seed));
    OK(jcas_sim_reset(flight->parts, seed));
    OK(jcas_batch_reset(flight->batch, seeds, 3, flight->others, 3 * flight->observation_count,
                        NULL, 0));
}

static void expect_state(struct flight *flight, jcas_sim *sim, char *line)
{
    uint64_t hash;
    OK(jcas_sim_hash(sim, &hash));
    CHECK(hash == hex_of(line, "state_hash"));
    OK(jcas_sim_observe(sim, flight->observations, flight->observation_count));
    uint64_t seen = hash_floats(flight->observations, flight->observation_count);
    CHECK(seen == hex_of(line, "observation_hash"));
}

static void step_batch(struct flight *flight, char *line)
{
    size_t count = flight->info.action_len;
    memcpy(flight->actions + count, flight->actions, count * sizeof(float));
    memcpy(flight->actions + 2 * count, flight->actions, count * sizeof(float));
    float rewards[3];
    uint8_t terminated[3], truncated[3];
    jcas_batch_out out;
    memset(&out, 0, sizeof out);
    out.struct_size = sizeof out;
    out.observations = flight->others;
    out.observation_count = 3 * flight->observation_count;
    out.rewards = rewards;
    out.terminated = terminated;
    out.truncated = truncated;
    out.reward_count = out.terminated_count = out.truncated_count = 3;
    OK(jcas_batch_step(flight->batch, flight->actions, 3 * count, 0, &out));
    for (uint32_t m = 0; m < 3; m++) {
        OK(jcas_batch_get(flight->batch, m, flight->twin));
        expect_state(flight, flight->twin, line);
        float *own = flight->others + m * flight->observation_count;
        CHECK(memcmp(own, flight->observations, flight->observation_count * sizeof(float)) == 0);
    }
}

static void step(struct flight *flight, char *line)
{
    size_t count = flight->info.action_len;
    read_actions(line, flight->actions, count);
    jcas_outcome outcome, other;
    outcome.struct_size = other.struct_size = sizeof outcome;

    OK(jcas_sim_step(flight->whole, flight->actions, count, &outcome));
    expect_state(flight, flight->whole, line);

    OK(jcas_sim_step_begin(flight->parts, flight->actions, count));
    OK(jcas_sim_step_sense(flight->parts));
    OK(jcas_sim_step_communicate(flight->parts));
    OK(jcas_sim_step_end(flight->parts, &other));
    expect_state(flight, flight->parts, line);
    CHECK(memcmp(&outcome, &other, sizeof outcome) == 0);

    step_batch(flight, line);

    /* From here on, the run by parts continues from a loaded snapshot of the whole one. */
    OK(jcas_sim_save(flight->whole, flight->snapshot, flight->info.snapshot_size));
    OK(jcas_sim_load(flight->parts, flight->snapshot, flight->info.snapshot_size));
    flight->steps++;
}

static void end(struct flight *flight, char *line)
{
    jcas_metrics metrics;
    metrics.struct_size = sizeof metrics;
    OK(jcas_sim_get_metrics(flight->whole, &metrics));
    CHECK(metrics.steps == flight->steps);
    CHECK(metrics.terminated == (strncmp(value_of(line, "terminated"), "true", 4) == 0));
    CHECK(metrics.truncated == (strncmp(value_of(line, "truncated"), "true", 4) == 0));
    CHECK(metrics.return_sum == strtod(value_of(line, "return_sum"), NULL));
    CHECK(metrics.co2_kg == strtod(value_of(line, "co2_kg"), NULL));
    jcas_outcome outcome;
    outcome.struct_size = sizeof outcome;
    EXPECT(JCAS_ERROR_EPISODE_OVER,
           jcas_sim_step(flight->whole, flight->actions, flight->info.action_len, &outcome));

    OK(jcas_sim_free(flight->whole));
    OK(jcas_sim_free(flight->parts));
    OK(jcas_sim_free(flight->twin));
    OK(jcas_batch_free(flight->batch));
    OK(jcas_model_free(flight->model));
    free(flight->parts_memory);
    free(flight->actions);
    free(flight->observations);
    free(flight->others);
    free(flight->snapshot);
}

static void replay(const char *path)
{
    FILE *file = fopen(path, "r");
    CHECK(file != NULL);
    struct flight flight;
    memset(&flight, 0, sizeof flight);
    int ended = 0;
    for (char *line; (line = read_line(file)) != NULL; free(line)) {
        char *kind = value_of(line, "kind");
        if (strncmp(kind, "\"header\"", 8) == 0) {
            begin(&flight, line);
            expect_state(&flight, flight.whole, line);
            expect_state(&flight, flight.parts, line);
        } else if (strncmp(kind, "\"step\"", 6) == 0) {
            step(&flight, line);
        } else {
            end(&flight, line);
            ended = 1;
        }
    }
    fclose(file);
    CHECK(ended && flight.steps > 0);
    printf("%s: %" PRIu64 " steps\n", path, flight.steps);
}

int main(int count, char **paths)
{
    CHECK(jcas_abi_check(JCAS_ABI_VERSION) == JCAS_OK);
    CHECK(count > 1);
    for (int i = 1; i < count; i++)
        replay(paths[i]);
    return 0;
}
