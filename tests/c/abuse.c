/* Every function gets every wrong argument: it returns a status each time, and changes nothing. */
#include "abuse_common.h"

uint64_t not_a_handle[4096];

static void tell_versions(void)
{
    CHECK(jcas_abi_version() == JCAS_ABI_VERSION);
    CHECK(jcas_abi_check(JCAS_ABI_VERSION) == JCAS_OK);
    CHECK(JCAS_ABI_VERSION == 0x01000000); /* 1.0, the first that was released */
    CHECK(jcas_abi_check(JCAS_ABI_VERSION + 65536) == JCAS_ERROR_ABI);
    CHECK(jcas_abi_check(JCAS_ABI_VERSION + 16777216) == JCAS_ERROR_ABI);
    CHECK(jcas_abi_check(0) == JCAS_ERROR_ABI);
    /* These are headers from before the first release. */
    CHECK(jcas_abi_check(0x00010000) == JCAS_ERROR_ABI);
    CHECK(jcas_abi_check(0x00010001) == JCAS_ERROR_ABI);
    char version[32];
    snprintf(version, sizeof version, "%d.%d.%d", JCAS_VERSION_MAJOR, JCAS_VERSION_MINOR,
             JCAS_VERSION_PATCH);
    CHECK(strcmp(version, jcas_version()) == 0);
    for (int32_t status = JCAS_ERROR_MEMORY; status <= JCAS_OK; status++)
        CHECK(strcmp(jcas_status_string(status), "not a status of jcas") != 0);
    CHECK(strcmp(jcas_status_string(1), "not a status of jcas") == 0);
    CHECK(strcmp(jcas_status_string(INT32_MIN), "not a status of jcas") == 0);
    CHECK(jcas_reward_name(UINT32_MAX) == NULL);
    CHECK(jcas_derive_seed(1, 0) == jcas_derive_seed(1, 0));
    CHECK(jcas_derive_seed(1, 0) != jcas_derive_seed(1, UINT64_MAX));
}

static void begin(struct subject *subject)
{
    OK(jcas_config_default(&subject->config, sizeof subject->config));
    subject->config.uav_count = 4;
    subject->config.hotspot_count = 3;
    subject->config.horizon_steps = 5;
    subject->config.search_maps = JCAS_MAPS_SHARED;
    subject->config.map_window_radius = 2;
    subject->config.map_directions = JCAS_DIRECTIONS_SHOWN;
    subject->config.uav_tag = JCAS_TAG_INDEX;
    subject->config.false_alarm_per_cell = 0.05;
    subject->config.report_levels = 2;
    subject->config.report_slots = 3;
    OK(jcas_model_new(&subject->config, &subject->model, NULL, 0));
    jcas_config other = subject->config;
    other.quorum = 2;
    OK(jcas_model_new(&other, &subject->other_model, NULL, 0));
    subject->info.struct_size = sizeof subject->info;
    OK(jcas_model_get_info(subject->model, &subject->info));
    OK(jcas_sim_new(subject->model, &subject->sim));
    OK(jcas_sim_new(subject->other_model, &subject->other_sim));
    OK(jcas_batch_new(subject->model, ENVIRONMENTS, 1, &subject->batch));
}

static void end(struct subject *subject)
{
    EXPECT(JCAS_ERROR_IN_USE, jcas_model_free(subject->model));
    OK(jcas_sim_free(subject->sim));
    EXPECT(JCAS_ERROR_IN_USE, jcas_model_free(subject->model));
    OK(jcas_batch_free(subject->batch));
    OK(jcas_model_free(subject->model));
    OK(jcas_sim_free(subject->other_sim));
    OK(jcas_model_free(subject->other_model));
    OK(jcas_sim_free(NULL));
    OK(jcas_batch_free(NULL));
    OK(jcas_model_free(NULL));
}

int main(void)
{
    struct subject subject;
    memset(&subject, 0, sizeof subject);
    tell_versions();
    begin(&subject);
    abuse_configurations(&subject);
    abuse_models(&subject);
    abuse_simulations(&subject);
    abuse_parts(&subject);
    abuse_reading(&subject);
    abuse_observation_fields(&subject);
    abuse_snapshots(&subject);
    abuse_batches(&subject);
    end(&subject);
    puts("every wrong call was refused");
    return 0;
}
