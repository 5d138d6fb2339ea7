/* Traces: recorded into a sink of this program and replayed, and the refusal of every wrong call.
 *
 *   traces FOLDER TRACE...
 *
 * The program verifies each trace. It then writes FOLDER/policy.jsonl with the policy `greedy`, and
 * FOLDER/hosted.jsonl with every kind of host call. */
#include "check.h"

enum { UAVS = 6, HOTSPOTS = 3, ACTIONS = 2 * UAVS, SEED = 11, ROOM = 1 << 22 };

static uint64_t not_a_handle[4096];
#define FOREIGN(type) ((type *)(void *)not_a_handle)

struct text {
    char *bytes;
    size_t length, room;
};

static int32_t take(const char *bytes, size_t count, void *context)
{
    struct text *text = context;
    if (count > text->room - text->length)
        return 1;
    memcpy(text->bytes + text->length, bytes, count);
    text->length += count;
    return 0;
}

static struct text text_with(size_t room)
{
    struct text text = {ARRAY(char, room), 0, room};
    return text;
}

static void write_file(const char *folder, const char *name, const struct text *text)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    CHECK(file != NULL && fwrite(text->bytes, 1, text->length, file) == text->length);
    CHECK(fclose(file) == 0);
}

static jcas_model *build(uint32_t uavs)
{
    jcas_config config;
    jcas_model *model;
    OK(jcas_config_default(&config, sizeof config));
    config.uav_count = uavs;
    config.hotspot_count = HOTSPOTS;
    config.range_min_m = 25;
    config.depot_count = 2;
    config.depots[0] = (jcas_cell){5, 5};
    config.depots[1] = (jcas_cell){0, 11};
    OK(jcas_model_new(&config, &model, NULL, 0));
    return model;
}

static void *workspace(const jcas_model *model, size_t *size)
{
    size_t alignment;
    OK(jcas_trace_layout(model, size, &alignment));
    CHECK(alignment <= 16);
    return allocated(*size);
}

/* Records a mission of a baseline. */
static void fly_policy(jcas_model *model, jcas_sim *sim, jcas_recorder recorder)
{
    jcas_policy *policy;
    float actions[ACTIONS];
    jcas_outcome outcome;
    memset(&outcome, 0, sizeof outcome);
    outcome.struct_size = sizeof outcome;
    OK(jcas_policy_baseline(model, "greedy", "max", &policy, NULL, 0));
    recorder.policy = "greedy";
    recorder.pilot = "max";
    OK(jcas_sim_record(sim, SEED, &recorder));
    while (!outcome.terminated && !outcome.truncated) {
        OK(jcas_policy_act(policy, sim, actions, ACTIONS));
        OK(jcas_sim_step(sim, actions, ACTIONS, &outcome));
    }
    OK(jcas_sim_record_end(sim));
    OK(jcas_policy_free(policy));
}

/* Records a mission in which the host makes every kind of call. */
static void fly_hosted(jcas_sim *sim, const jcas_recorder *recorder)
{
    jcas_cell starts[UAVS], hotspots[HOTSPOTS] = {{1, 1}, {2, 7}, {9, 3}};
    uint64_t charges[UAVS];
    uint8_t links[UAVS * UAVS] = {0}, detections[UAVS * HOTSPOTS] = {0};
    double throughput[UAVS];
    float actions[ACTIONS];
    jcas_outcome outcome;
    memset(&outcome, 0, sizeof outcome);
    outcome.struct_size = sizeof outcome;
    for (uint32_t i = 0; i < UAVS; i++) {
        starts[i] = (jcas_cell){i, 2};
        charges[i] = 400000000000u + i;
        throughput[i] = 0.1 * i;
        actions[2 * i] = i == 1 ? INFINITY : 0.1f * (float)i;
        actions[2 * i + 1] = -1 + 0.3f * (float)i;
    }
    links[1] = links[UAVS] = links[2 * UAVS + 5] = links[5 * UAVS + 2] = 9;
    detections[0] = detections[HOTSPOTS] = detections[2 * HOTSPOTS] = detections[17] = 1;
    OK(jcas_sim_record(sim, SEED, recorder));
    OK(jcas_sim_set_starts(sim, starts, UAVS));
    OK(jcas_sim_set_hotspots(sim, hotspots, HOTSPOTS));
    OK(jcas_sim_set_batteries(sim, charges, UAVS));
    /* A refused call is in no trace. */
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_set_battery(sim, UAVS, 1));
    for (uint32_t step = 0; step < 12; step++) {
        if (step == 3) {
            OK(jcas_sim_set_battery(sim, 4, 5));
            OK(jcas_sim_move_hotspot(sim, 2, 4, 4));
        }
        OK(jcas_sim_step_begin(sim, actions, ACTIONS));
        EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_record_end(sim));
        if (step % 2) {
            starts[step % UAVS].y++;
            OK(jcas_sim_set_positions(sim, starts, UAVS));
            OK(jcas_sim_ground(sim, step % UAVS));
        }
        if (step == 7)
            OK(jcas_sim_confirm_hotspot(sim, 1));
        if (step % 3)
            OK(jcas_sim_step_sense_with(sim, detections, UAVS * HOTSPOTS));
        else
            OK(jcas_sim_step_sense(sim));
        if (step % 4)
            OK(jcas_sim_step_communicate_with(sim, links, UAVS * UAVS, step % 2 ? throughput : NULL,
                                              step % 2 ? UAVS : 0));
        else
            OK(jcas_sim_step_communicate(sim));
        OK(jcas_sim_step_end(sim, &outcome));
    }
    OK(jcas_sim_set_battery(sim, 0, 7));
    OK(jcas_sim_record_end(sim));
    EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_record_end(sim));
    char why[100];
    size_t said;
    OK(jcas_sim_message(sim, why, sizeof why, &said));
    CHECK(strcmp(why, "nothing is recorded: jcas_sim_record begins a recording") == 0);
}

/* Replays a trace step by step in a simulation of its own. It counts t, and its last state is that
 * of the whole replay. */
static void verify_by_steps(jcas_sim *sim, void *memory, size_t size, const char *trace,
                            size_t length)
{
    jcas_episode episode;
    uint64_t at_once, by_steps;
    size_t offset = 0;
    memset(&episode, 0, sizeof episode);
    episode.struct_size = sizeof episode;
    OK(jcas_sim_hash(sim, &at_once));
    OK(jcas_sim_get_episode(sim, &episode));
    uint32_t last = episode.t;
    for (uint32_t t = 0; t <= last; t++) {
        OK(jcas_trace_step(sim, memory, size, trace, length, &offset, NULL, 0));
        OK(jcas_sim_get_episode(sim, &episode));
        CHECK(episode.t == t && trace[offset - 1] == '\n' && offset < length);
    }
    OK(jcas_trace_step(sim, memory, size, trace, length, &offset, NULL, 0));
    CHECK(offset == length);
    OK(jcas_sim_hash(sim, &by_steps));
    CHECK(at_once == by_steps);
}

static int32_t verify(const char *trace, size_t length, char *why, size_t room)
{
    jcas_config config;
    jcas_model *model;
    jcas_sim *sim;
    size_t size;
    int32_t status = jcas_trace_config(trace, length, &config, sizeof config, why, room);
    if (status != JCAS_OK)
        return status;
    OK(jcas_model_new(&config, &model, NULL, 0));
    OK(jcas_sim_new(model, &sim));
    void *memory = workspace(model, &size);
    status = jcas_trace_verify(sim, memory, size, trace, length, why, room);
    if (status == JCAS_OK)
        verify_by_steps(sim, memory, size, trace, length);
    free(memory);
    OK(jcas_sim_free(sim));
    OK(jcas_model_free(model));
    return status;
}

static void verify_file(const char *path)
{
    struct text text = text_with(ROOM);
    char why[256] = "";
    FILE *file = fopen(path, "rb");
    CHECK(file != NULL);
    text.length = fread(text.bytes, 1, text.room, file);
    fclose(file);
    CHECK(text.length > 1000 && text.length < text.room);
    if (verify(text.bytes, text.length, why, sizeof why) != JCAS_OK) {
        fprintf(stderr, "%s: %s\n", path, why);
        exit(1);
    }
    free(text.bytes);
}

/* Gives a changed text the matching checksum. */
static void seal(struct text *text)
{
    static const char KEY[] = ",\"checksum\":\"0x";
    uint64_t hash = 0xcbf29ce484222325u;
    size_t at = text->length - strlen("0123456789abcdef\"}\n") - strlen(KEY);
    CHECK(memcmp(text->bytes + at, KEY, strlen(KEY)) == 0);
    for (size_t i = 0; i < at; i++)
        hash = (hash ^ (unsigned char)text->bytes[i]) * 0x100000001b3u;
    char digits[17];
    snprintf(digits, sizeof digits, "%016llx", (unsigned long long)hash);
    memcpy(text->bytes + at + strlen(KEY), digits, 16);
}

/* Any damage to a file gives a status; changed bytes are detected with and without a matching
 * checksum. */
static void damage(const struct text *whole)
{
    char why[256];
    struct text text = text_with(whole->length);
    text.length = whole->length;
    for (size_t end = 0; end < whole->length; end += 1 + end / 30)
        EXPECT(JCAS_ERROR_CORRUPT, verify(whole->bytes, end, why, sizeof why));
    uint32_t random = 1;
    for (int trial = 0; trial < 400; trial++) {
        random = random * 1664525u + 1013904223u;
        size_t place = random % (whole->length - 20);
        memcpy(text.bytes, whole->bytes, whole->length);
        text.bytes[place] ^= (char)(1 << trial % 7);
        int32_t status = verify(text.bytes, text.length, why, sizeof why);
        CHECK(status == JCAS_ERROR_CORRUPT || status == JCAS_ERROR_DIFFERENT);
        if (place + 60 > whole->length)
            continue;
        seal(&text);
        why[0] = 0;
        status = verify(text.bytes, text.length, why, sizeof why);
        /* With a matching checksum, only changes without effect pass, such as the policy's name. */
        CHECK(status == JCAS_OK || status == JCAS_ERROR_CORRUPT || status == JCAS_ERROR_DIFFERENT);
        CHECK((status == JCAS_OK) == (why[0] == 0));
    }
    /* The checksum in capitals is the same number, but not the same bytes. */
    memcpy(text.bytes, whole->bytes, whole->length);
    int capitals = 0;
    char *checksum = text.bytes + whole->length - 19;
    for (char *digit = checksum; digit < checksum + 16; digit++)
        if (*digit >= 'a' && *digit <= 'f')
            *digit -= 'a' - 'A', capitals++;
    CHECK(capitals > 0);
    EXPECT(JCAS_ERROR_CORRUPT, verify(text.bytes, text.length, why, sizeof why));
    char *battery = strstr(memcpy(text.bytes, whole->bytes, whole->length), "\"kind\":\"step\"");
    battery = strstr(battery, "\"battery_uj\":[") + 15;
    *battery = *battery == '9' ? '8' : '9';
    seal(&text);
    EXPECT(JCAS_ERROR_DIFFERENT, verify(text.bytes, text.length, why, sizeof why));
    CHECK(strstr(why, "line ") != NULL && strstr(why, "battery_uj differs") != NULL);
    free(text.bytes);
}

/* A full sink ends the recording, never the mission. */
static void fill_sink(jcas_sim *sim, jcas_recorder recorder, struct text *text)
{
    uint64_t before, after;
    size_t whole = text->length;
    jcas_outcome outcome;
    float actions[ACTIONS] = {0};
    memset(&outcome, 0, sizeof outcome);
    outcome.struct_size = sizeof outcome;
    OK(jcas_sim_hash(sim, &before));
    text->length = 0;
    text->room = 10;
    EXPECT(JCAS_ERROR_SINK, jcas_sim_record(sim, 99, &recorder));
    OK(jcas_sim_hash(sim, &after));
    CHECK(before == after && text->length == 0);
    text->room = whole / 3;
    OK(jcas_sim_record(sim, SEED, &recorder));
    for (int step = 0; step < 30; step++)
        OK(jcas_sim_step(sim, actions, ACTIONS, &outcome));
    EXPECT(JCAS_ERROR_SINK, jcas_sim_record_end(sim));
    EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_record_end(sim));
    CHECK(text->length <= text->room);

    /* Another state ends a recording without an end line. */
    text->length = 0;
    text->room = ROOM;
    OK(jcas_sim_record(sim, SEED, &recorder));
    OK(jcas_sim_reset(sim, SEED));
    EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_record_end(sim));
    EXPECT(JCAS_ERROR_CORRUPT, verify(text->bytes, text->length, NULL, 0));
}

static const char ILLEGAL[] = "{\"kind\":\"header\",\"format\":\"jcas-trace\",\"format_version\":1,"
                              "\"core_version\":\"0.1.0\",\"config\":{\"uav_count\":0},";

static void abuse(jcas_model *model, jcas_sim *sim, jcas_recorder recorder,
                  const struct text *trace)
{
    size_t size = 7, alignment = 7;
    jcas_config config;
    jcas_recorder wrong = recorder;
    uint64_t before, after;
    OK(jcas_sim_hash(sim, &before));
    EXPECT(JCAS_ERROR_NULL, jcas_trace_layout(NULL, &size, &alignment));
    EXPECT(JCAS_ERROR_NULL, jcas_trace_layout(model, NULL, &alignment));
    EXPECT(JCAS_ERROR_NULL, jcas_trace_layout(model, &size, NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_trace_layout(FOREIGN(jcas_model), &size, &alignment));
    CHECK(size == 7 && alignment == 7);
    EXPECT(JCAS_ERROR_NULL, jcas_sim_record(NULL, 1, &recorder));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_record(sim, 1, NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_record(FOREIGN(jcas_sim), 1, &recorder));
    wrong.struct_size--;
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_sim_record(sim, 1, &wrong));
    wrong = recorder;
    wrong.write = NULL;
    EXPECT(JCAS_ERROR_NULL, jcas_sim_record(sim, 1, &wrong));
    wrong = recorder;
    wrong.memory = NULL;
    EXPECT(JCAS_ERROR_NULL, jcas_sim_record(sim, 1, &wrong));
    wrong.memory = (char *)recorder.memory + 1;
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_sim_record(sim, 1, &wrong));
    wrong = recorder;
    wrong.memory_size--;
    EXPECT(JCAS_ERROR_LENGTH, jcas_sim_record(sim, 1, &wrong));
    wrong = recorder;
    wrong.reserved = 1;
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_record(sim, 1, &wrong));
    wrong = recorder;
    wrong.policy = "\xff";
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_sim_record(sim, 1, &wrong));
    EXPECT(JCAS_ERROR_NULL, jcas_sim_record_end(NULL));
    EXPECT(JCAS_ERROR_HANDLE, jcas_sim_record_end(FOREIGN(jcas_sim)));
    EXPECT(JCAS_ERROR_OUT_OF_ORDER, jcas_sim_record_end(sim));

    mark(&config, sizeof config);
    const char *text = trace->bytes;
    size_t length = trace->length;
    EXPECT(JCAS_ERROR_NULL, jcas_trace_config(NULL, length, &config, sizeof config, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_trace_config(text, length, NULL, sizeof config, NULL, 0));
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_trace_config(text, length, &config, 4, NULL, 0));
    EXPECT(JCAS_ERROR_CORRUPT, jcas_trace_config("\xff", 1, &config, sizeof config, NULL, 0));
    char refused[128] = "";
    EXPECT(JCAS_ERROR_CORRUPT, jcas_trace_config(ILLEGAL, sizeof ILLEGAL - 1, &config,
                                                 sizeof config, refused, sizeof refused));
    CHECK(strcmp(refused, "line 1: uav_count = 0: must be a whole number from 1 to 4096") == 0);
    CHECK(untouched(&config, sizeof config));
    size = recorder.memory_size;
    void *memory = recorder.memory;
    EXPECT(JCAS_ERROR_NULL, jcas_trace_verify(NULL, memory, size, text, length, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_trace_verify(sim, NULL, size, text, length, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_trace_verify(sim, memory, size, NULL, length, NULL, 0));
    EXPECT(JCAS_ERROR_LENGTH, jcas_trace_verify(sim, memory, size - 1, text, length, NULL, 0));
    EXPECT(JCAS_ERROR_HANDLE,
           jcas_trace_verify(FOREIGN(jcas_sim), memory, size, text, length, NULL, 0));
    size_t offset = 0;
    EXPECT(JCAS_ERROR_NULL, jcas_trace_step(NULL, memory, size, text, length, &offset, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_trace_step(sim, NULL, size, text, length, &offset, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_trace_step(sim, memory, size, NULL, length, &offset, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_trace_step(sim, memory, size, text, length, NULL, NULL, 0));
    EXPECT(JCAS_ERROR_LENGTH,
           jcas_trace_step(sim, memory, size - 1, text, length, &offset, NULL, 0));
    EXPECT(JCAS_ERROR_HANDLE,
           jcas_trace_step(FOREIGN(jcas_sim), memory, size, text, length, &offset, NULL, 0));
    EXPECT(JCAS_ERROR_CORRUPT,
           jcas_trace_step(sim, memory, size, text, length - 1, &offset, NULL, 0));
    CHECK(offset == 0);
    for (offset = length; offset < length + 2; offset++)
        EXPECT(JCAS_ERROR_CORRUPT,
               jcas_trace_step(sim, memory, size, text, length, &offset, NULL, 0));
    offset = 7;
    EXPECT(JCAS_ERROR_CORRUPT, jcas_trace_step(sim, memory, size, text, length, &offset, NULL, 0));
    CHECK(offset == 7);
    OK(jcas_sim_hash(sim, &after));
    CHECK(before == after);

    char why[128] = "";
    jcas_model *other = build(UAVS - 1);
    jcas_sim *foreign;
    OK(jcas_sim_new(other, &foreign));
    EXPECT(JCAS_ERROR_MODEL_MISMATCH,
           jcas_trace_verify(foreign, memory, size, text, length, why, sizeof why));
    CHECK(strstr(why, "another configuration") != NULL);
    OK(jcas_sim_free(foreign));
    OK(jcas_model_free(other));
}

int main(int argc, char **argv)
{
    CHECK(argc >= 2);
    for (int i = 2; i < argc; i++)
        verify_file(argv[i]);

    jcas_model *model = build(UAVS);
    jcas_sim *sim;
    OK(jcas_sim_new(model, &sim));
    struct text text = text_with(ROOM);
    jcas_recorder recorder;
    memset(&recorder, 0, sizeof recorder);
    recorder.struct_size = sizeof recorder;
    recorder.write = take;
    recorder.write_context = &text;
    recorder.memory = workspace(model, &recorder.memory_size);

    fly_policy(model, sim, recorder);
    write_file(argv[1], "policy.jsonl", &text);
    OK(verify(text.bytes, text.length, NULL, 0));
    text.length = 0;
    recorder.policy = "a \"host\"\\\n\x01";
    fly_hosted(sim, &recorder);
    write_file(argv[1], "hosted.jsonl", &text);
    char why[256] = "";
    if (verify(text.bytes, text.length, why, sizeof why) != JCAS_OK) {
        fprintf(stderr, "hosted: %s\n", why);
        return 1;
    }
    damage(&text);
    abuse(model, sim, recorder, &text);
    fill_sink(sim, recorder, &text);

    free(recorder.memory);
    free(text.bytes);
    OK(jcas_sim_free(sim));
    OK(jcas_model_free(model));
    puts("traces hold");
    return 0;
}
