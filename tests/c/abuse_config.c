/* Configurations and models. */
#include "abuse_common.h"

static void abuse_filling(void)
{
    jcas_config config;
    char message[64];
    mark(&config, sizeof config);
    EXPECT(JCAS_ERROR_NULL, jcas_config_default(NULL, sizeof config));
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_config_default(ASKEW(jcas_config, &config), sizeof config));
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_config_default(&config, sizeof config - 8));
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_config_default(&config, sizeof config + 8));
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_config_default(&config, 0));

    size_t size = sizeof config;
    EXPECT(JCAS_ERROR_NULL, jcas_config_preset(NULL, 5, &config, size, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_config_preset("paper", 5, NULL, size, NULL, 0));
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_config_preset("paper", 5, &config, size - 1, NULL, 0));
    EXPECT(JCAS_ERROR_CONFIG,
           jcas_config_preset("best", 4, &config, size, message, sizeof message));
    CHECK(strcmp(message, "preset = best: must be `mission`, `paper`, `search` or `isac`") == 0);
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_preset("best", 4, &config, size, NULL, 10));
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_preset("best", 4, &config, size, message, 0));
    EXPECT(JCAS_ERROR_CONFIG,
           jcas_config_preset("\xff\xfe", 2, &config, size, message, sizeof message));
    EXPECT(JCAS_ERROR_LENGTH, jcas_config_preset("paper", SIZE_MAX, &config, size, NULL, 0));

    EXPECT(JCAS_ERROR_NULL, jcas_config_from_toml(NULL, 0, &config, size, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_config_from_toml("", 0, NULL, size, NULL, 0));
    EXPECT(JCAS_ERROR_CONFIG,
           jcas_config_from_toml("uav_count = 0", 13, &config, size, message, 10));
    CHECK(strcmp(message, "uav_count") == 0); /* cut to ten bytes */
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_from_toml("\0", 1, &config, size, NULL, 0));
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_from_json("", 0, &config, size, NULL, 0));
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_from_json("[]", 2, &config, size, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_config_from_json(NULL, 1, &config, size, NULL, 0));
    CHECK(untouched(&config, sizeof config));
    OK(jcas_config_from_toml("", 0, &config, size, NULL, 0));
    OK(jcas_config_preset("paper", 5, &config, size, NULL, 0));
    CHECK(config.charge_billing == JCAS_BILLING_NAMEPLATE);
}

static void abuse_fields(const struct subject *subject)
{
    jcas_config config = subject->config;
    char message[256];
    uint64_t hash;
    mark(&hash, sizeof hash);
    OK(jcas_config_validate(&config, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_config_validate(NULL, message, sizeof message));
    config.struct_size = 0;
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_config_validate(&config, message, sizeof message));
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_config_hash(&config, &hash));
    config = subject->config;
    config.depot_count = JCAS_MAX_DEPOTS + 1;
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_validate(&config, message, sizeof message));
    CHECK(strstr(message, "depot_count = 17") != NULL);
    config = subject->config;
    config.detection_point_count = JCAS_MAX_DETECTION_POINTS + 1;
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_validate(&config, message, sizeof message));
    CHECK(strstr(message, "detection_point_count = 65") != NULL);
    config = subject->config;
    config.target_visibility = 2;
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_validate(&config, message, sizeof message));
    CHECK(strstr(message, "target_visibility = 2") != NULL);
    config.target_visibility = -1;
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_validate(&config, message, sizeof message));
    config = subject->config;
    config.uav_tag = 2;
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_validate(&config, message, sizeof message));
    CHECK(strstr(message, "uav_tag = 2") != NULL);
    config = subject->config;
    config.report_levels = 0; /* which leaves no reports to list */
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_validate(&config, message, sizeof message));
    CHECK(strstr(message, "report_slots = 3") != NULL);
    config.report_slots = 0;
    config.search_maps = JCAS_MAPS_OFF; /* which leaves a window of nothing */
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_validate(&config, message, sizeof message));
    CHECK(strstr(message, "map_window_radius = 2") != NULL);
    config = subject->config;
    config.cell_size_m = JCAS_DERIVED; /* only three fields can be derived */
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_validate(&config, message, sizeof message));
    CHECK(strstr(message, "cell_size_m") != NULL);
    config = subject->config;
    config.uav_count = 5000;
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_hash(&config, &hash));
    CHECK(untouched(&hash, sizeof hash));
    EXPECT(JCAS_ERROR_NULL, jcas_config_hash(&subject->config, NULL));
    OK(jcas_config_hash(&subject->config, &hash));
    CHECK(hash == subject->info.config_hash);
    config = subject->config;
    config.range_min_m = 25.0;
    OK(jcas_config_validate(&config, NULL, 0));
    /* The sign of a zero changes nothing. */
    uint64_t unsigned_zero;
    config.sense_energy_kwh = 0.0;
    OK(jcas_config_hash(&config, &unsigned_zero));
    config.sense_energy_kwh = -0.0;
    OK(jcas_config_hash(&config, &hash));
    CHECK(hash == unsigned_zero);
}

/* A table in the struct is the same as one in a text; one that rises is refused. */
static void abuse_detection_table(void)
{
    const char *text = "detection_curve = 'table'\ndetection_table = [[20, 0.9], [80, 0.1]]";
    jcas_config given, read;
    uint64_t hash, of_text;
    char message[256];
    OK(jcas_config_default(&given, sizeof given));
    given.detection_curve = JCAS_CURVE_TABLE;
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_validate(&given, message, sizeof message));
    CHECK(strstr(message, "detection_table = []: must be a list of 1 to 64") != NULL);
    given.detection_point_count = 2;
    given.detection_table[0] = (jcas_detection_point){20, 0.9};
    given.detection_table[1] = (jcas_detection_point){80, 0.1};
    given.detection_table[2] = (jcas_detection_point){-1, 7}; /* which is not read */
    OK(jcas_config_hash(&given, &hash));
    OK(jcas_config_from_toml(text, strlen(text), &read, sizeof read, NULL, 0));
    OK(jcas_config_hash(&read, &of_text));
    CHECK(hash == of_text);
    CHECK(read.detection_point_count == 2 && read.detection_table[1].range_m == 80);
    CHECK(read.detection_table[1].probability == 0.1 && read.detection_table[2].range_m == 0);
    given.detection_table[1].probability = 0.6;
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_validate(&given, message, sizeof message));
    CHECK(strstr(message, "end with a P_d of at most 0.1") != NULL);
    given.detection_table[1].probability = 0.95;
    EXPECT(JCAS_ERROR_CONFIG, jcas_config_validate(&given, message, sizeof message));
    CHECK(strstr(message, "detection_table = [80.0, 0.95]: must be pairs") != NULL);
}

typedef int32_t text_function(const jcas_config *, char *, size_t, size_t *);

static void abuse_text(const struct subject *subject, text_function *write)
{
    size_t length, other;
    mark(&length, sizeof length);
    EXPECT(JCAS_ERROR_NULL, write(&subject->config, NULL, 0, NULL));
    EXPECT(JCAS_ERROR_NULL, write(&subject->config, NULL, 7, &length));
    EXPECT(JCAS_ERROR_NULL, write(NULL, NULL, 0, &length));
    CHECK(untouched(&length, sizeof length));
    OK(write(&subject->config, NULL, 0, &length));
    char *text = ARRAY(char, length + 1);
    mark(text, length + 1);
    mark(&other, sizeof other);
    EXPECT(JCAS_ERROR_LENGTH, write(&subject->config, text, length, &other));
    CHECK(untouched(text, length + 1) && other == length); /* the length that it takes */
    OK(write(&subject->config, text, length + 1, &other));
    CHECK(other == length && strlen(text) == length);
    jcas_config back;
    OK(text[0] == '{' ? jcas_config_from_json(text, length, &back, sizeof back, NULL, 0)
                      : jcas_config_from_toml(text, length, &back, sizeof back, NULL, 0));
    uint64_t hash;
    OK(jcas_config_hash(&back, &hash));
    CHECK(hash == subject->info.config_hash);
    free(text);
}

void abuse_configurations(struct subject *subject)
{
    abuse_filling();
    abuse_fields(subject);
    abuse_detection_table();
    abuse_text(subject, jcas_config_to_json);
    abuse_text(subject, jcas_config_to_toml);
    size_t length;
    OK(jcas_config_fields(NULL, 0, &length));
    EXPECT(JCAS_ERROR_NULL, jcas_config_fields(NULL, 0, NULL));
    EXPECT(JCAS_ERROR_NULL, jcas_config_fields(NULL, 1, &length));
}

static void abuse_building(const struct subject *subject)
{
    jcas_config bad = subject->config;
    bad.quorum = 0;
    char message[128];
    size_t size, alignment;
    mark(&size, sizeof size);
    mark(&alignment, sizeof alignment);
    EXPECT(JCAS_ERROR_NULL, jcas_model_layout(NULL, &size, &alignment, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_model_layout(&subject->config, NULL, &alignment, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_model_layout(&subject->config, &size, NULL, NULL, 0));
    EXPECT(JCAS_ERROR_CONFIG, jcas_model_layout(&bad, &size, &alignment, message, sizeof message));
    CHECK(strcmp(message, "quorum = 0: must be a whole number from 1 to 4096") == 0);
    CHECK(untouched(&size, sizeof size) && untouched(&alignment, sizeof alignment));
    OK(jcas_model_layout(&subject->config, &size, &alignment, NULL, 0));

    jcas_model *model;
    mark(&model, sizeof model);
    unsigned char *memory = ARRAY(unsigned char, size + 1);
    mark(memory, size + 1);
    const jcas_config *config = &subject->config;
    EXPECT(JCAS_ERROR_NULL, jcas_model_init(NULL, size, config, &model, NULL, 0));
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_model_init(memory + 1, size, config, &model, NULL, 0));
    EXPECT(JCAS_ERROR_LENGTH, jcas_model_init(memory, size - 1, config, &model, NULL, 0));
    EXPECT(JCAS_ERROR_LENGTH, jcas_model_init(memory, 0, config, &model, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_model_init(memory, size, config, NULL, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_model_init(memory, size, NULL, &model, NULL, 0));
    EXPECT(JCAS_ERROR_CONFIG, jcas_model_init(memory, size, &bad, &model, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_model_new(config, NULL, NULL, 0));
    EXPECT(JCAS_ERROR_NULL, jcas_model_new(NULL, &model, NULL, 0));
    EXPECT(JCAS_ERROR_CONFIG, jcas_model_new(&bad, &model, NULL, 0));
    CHECK(untouched(memory, size + 1) && untouched(&model, sizeof model));

    OK(jcas_model_init(memory, size, config, &model, NULL, 0));
    CHECK(memory[size] == 0xa5);
    jcas_model *over;
    EXPECT(JCAS_ERROR_IN_USE, jcas_model_init(memory, size, config, &over, NULL, 0));
    /* A copy of a model is not valid, and neither is a freed model. */
    unsigned char *copy = ARRAY(unsigned char, size);
    memcpy(copy, memory, size);
    jcas_model_info info;
    info.struct_size = sizeof info;
    EXPECT(JCAS_ERROR_HANDLE, jcas_model_get_info((jcas_model *)(void *)copy, &info));
    OK(jcas_model_free(model));
    EXPECT(JCAS_ERROR_HANDLE, jcas_model_free(model));
    EXPECT(JCAS_ERROR_HANDLE, jcas_model_get_info(model, &info));
    free(copy);
    free(memory);
}

void abuse_models(struct subject *subject)
{
    abuse_building(subject);
    jcas_model_info info;
    mark(&info, sizeof info);
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_model_get_info(subject->model, &info));
    EXPECT(JCAS_ERROR_NULL, jcas_model_get_info(subject->model, NULL));
    EXPECT(JCAS_ERROR_NULL, jcas_model_get_info(NULL, &info));
    EXPECT(JCAS_ERROR_HANDLE, jcas_model_get_info(FOREIGN(jcas_model), &info));
    EXPECT(JCAS_ERROR_HANDLE, jcas_model_get_info((jcas_model *)(void *)subject->sim, &info));
    EXPECT(JCAS_ERROR_ALIGNMENT, jcas_model_get_info(ASKEW(jcas_model, not_a_handle), &info));
    EXPECT(JCAS_ERROR_HANDLE, jcas_model_free(FOREIGN(jcas_model)));
    CHECK(untouched(&info, sizeof info));

    jcas_config config;
    mark(&config, sizeof config);
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_model_get_config(subject->model, &config, 12));
    EXPECT(JCAS_ERROR_NULL, jcas_model_get_config(subject->model, NULL, sizeof config));
    EXPECT(JCAS_ERROR_HANDLE, jcas_model_get_config(FOREIGN(jcas_model), &config, sizeof config));
    CHECK(untouched(&config, sizeof config));
    OK(jcas_model_get_config(subject->model, &config, sizeof config));
    CHECK(config.uav_count == 4 && isnan(config.range_min_m));

    jcas_radio radio, kept;
    mark(&radio, sizeof radio);
    EXPECT(JCAS_ERROR_STRUCT_SIZE, jcas_model_get_radio(subject->model, 0, 0, 0.1, &radio));
    radio.struct_size = sizeof radio;
    kept = radio;
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_model_get_radio(subject->model, 12, 0, 0.1, &radio));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_model_get_radio(subject->model, 0, UINT32_MAX, 0.1, &radio));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_model_get_radio(subject->model, 0, 0, 1.1, &radio));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_model_get_radio(subject->model, 0, 0, (double)NAN, &radio));
    EXPECT(JCAS_ERROR_NULL, jcas_model_get_radio(subject->model, 0, 0, 0.1, NULL));
    EXPECT(JCAS_ERROR_NULL, jcas_model_get_radio(NULL, 0, 0, 0.1, &radio));
    EXPECT(JCAS_ERROR_HANDLE, jcas_model_get_radio(FOREIGN(jcas_model), 0, 0, 0.1, &radio));
    CHECK(memcmp(&radio, &kept, sizeof radio) == 0);
    OK(jcas_model_get_radio(subject->model, 1, 0, 0.3, &radio));
    CHECK(fabs(radio.comm_snr_db - 32.30) < 0.01 && radio.link_throughput > 1.0);
}
