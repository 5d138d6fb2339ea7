/* Types of the functions of jcas.h, for programs that load the library when they run:
 *
 *     jcas_sim_step_fn *step = (jcas_sim_step_fn *)dlsym(library, "jcas_sim_step");
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef JCAS_DL_H
#define JCAS_DL_H

#include "jcas.h"

typedef const char *jcas_version_fn(void);
typedef uint32_t jcas_abi_version_fn(void);
typedef jcas_status jcas_abi_check_fn(uint32_t header_abi_version);
typedef const char *jcas_status_string_fn(jcas_status status);
typedef jcas_status jcas_config_default_fn(struct jcas_config *config, size_t struct_size);
typedef jcas_status jcas_config_preset_fn(const char *name, size_t name_length, struct jcas_config *config, size_t struct_size, char *message, size_t message_capacity);
typedef jcas_status jcas_config_from_toml_fn(const char *text, size_t text_length, struct jcas_config *config, size_t struct_size, char *message, size_t message_capacity);
typedef jcas_status jcas_config_from_json_fn(const char *text, size_t text_length, struct jcas_config *config, size_t struct_size, char *message, size_t message_capacity);
typedef jcas_status jcas_config_validate_fn(const struct jcas_config *config, char *message, size_t message_capacity);
typedef jcas_status jcas_config_hash_fn(const struct jcas_config *config, uint64_t *hash);
typedef jcas_status jcas_config_to_json_fn(const struct jcas_config *config, char *text, size_t capacity, size_t *length);
typedef jcas_status jcas_config_to_toml_fn(const struct jcas_config *config, char *text, size_t capacity, size_t *length);
typedef jcas_status jcas_config_fields_fn(char *text, size_t capacity, size_t *length);
typedef jcas_status jcas_model_layout_fn(const struct jcas_config *config, size_t *size, size_t *alignment, char *message, size_t message_capacity);
typedef jcas_status jcas_model_init_fn(void *memory, size_t size, const struct jcas_config *config, struct jcas_model **model, char *message, size_t message_capacity);
typedef jcas_status jcas_model_new_fn(const struct jcas_config *config, struct jcas_model **model, char *message, size_t message_capacity);
typedef jcas_status jcas_model_free_fn(struct jcas_model *model);
typedef jcas_status jcas_model_get_info_fn(const struct jcas_model *model, struct jcas_model_info *info);
typedef jcas_status jcas_model_observation_fields_fn(const struct jcas_model *model, struct jcas_observation_field *fields, size_t count, size_t struct_size);
typedef const char *jcas_observation_field_name_fn(uint32_t index);
typedef jcas_status jcas_model_get_config_fn(const struct jcas_model *model, struct jcas_config *config, size_t struct_size);
typedef jcas_status jcas_model_get_radio_fn(const struct jcas_model *model, uint32_t dx, uint32_t dy, double pilot_density, struct jcas_radio *radio);
typedef jcas_status jcas_sim_layout_fn(const struct jcas_model *model, size_t *size, size_t *alignment);
typedef jcas_status jcas_sim_init_fn(void *memory, size_t size, const struct jcas_model *model, struct jcas_sim **sim);
typedef jcas_status jcas_sim_new_fn(const struct jcas_model *model, struct jcas_sim **sim);
typedef jcas_status jcas_sim_free_fn(struct jcas_sim *sim);
typedef jcas_status jcas_sim_reset_fn(struct jcas_sim *sim, uint64_t seed);
typedef uint64_t jcas_derive_seed_fn(uint64_t seed, uint64_t index);
typedef jcas_status jcas_sim_step_fn(struct jcas_sim *sim, const float *actions, size_t action_count, struct jcas_outcome *outcome);
typedef jcas_status jcas_sim_observe_fn(struct jcas_sim *sim, float *observations, size_t count);
typedef jcas_status jcas_sim_observe_global_fn(const struct jcas_sim *sim, float *global, size_t count);
typedef jcas_status jcas_sim_message_fn(const struct jcas_sim *sim, char *text, size_t capacity, size_t *length);
typedef jcas_status jcas_sim_step_begin_fn(struct jcas_sim *sim, const float *actions, size_t action_count);
typedef jcas_status jcas_sim_set_positions_fn(struct jcas_sim *sim, const struct jcas_cell *cells, size_t count);
typedef jcas_status jcas_sim_step_sense_fn(struct jcas_sim *sim);
typedef jcas_status jcas_sim_ground_fn(struct jcas_sim *sim, uint32_t uav);
typedef jcas_status jcas_sim_confirm_hotspot_fn(struct jcas_sim *sim, uint32_t hotspot);
typedef jcas_status jcas_sim_step_sense_with_fn(struct jcas_sim *sim, const uint8_t *detections, size_t count);
typedef jcas_status jcas_sim_step_communicate_fn(struct jcas_sim *sim);
typedef jcas_status jcas_sim_step_communicate_with_fn(struct jcas_sim *sim, const uint8_t *links, size_t link_count, const double *throughput, size_t throughput_count);
typedef jcas_status jcas_sim_step_end_fn(struct jcas_sim *sim, struct jcas_outcome *outcome);
typedef jcas_status jcas_sim_set_hotspots_fn(struct jcas_sim *sim, const struct jcas_cell *cells, size_t count);
typedef jcas_status jcas_sim_move_hotspot_fn(struct jcas_sim *sim, uint32_t hotspot, uint32_t x, uint32_t y);
typedef jcas_status jcas_sim_set_starts_fn(struct jcas_sim *sim, const struct jcas_cell *cells, size_t count);
typedef jcas_status jcas_sim_set_battery_fn(struct jcas_sim *sim, uint32_t uav, uint64_t charge_uj);
typedef jcas_status jcas_sim_set_batteries_fn(struct jcas_sim *sim, const uint64_t *charges_uj, size_t count);
typedef jcas_status jcas_sim_get_episode_fn(const struct jcas_sim *sim, struct jcas_episode *episode);
typedef jcas_status jcas_sim_get_metrics_fn(const struct jcas_sim *sim, struct jcas_metrics *metrics);
typedef jcas_status jcas_sim_get_rewards_fn(const struct jcas_sim *sim, double *components, size_t count);
typedef jcas_status jcas_sim_uav_rewards_fn(const struct jcas_sim *sim, double *rewards, size_t count);
typedef jcas_status jcas_sim_uav_reward_components_fn(const struct jcas_sim *sim, double *components, size_t count);
typedef const char *jcas_reward_name_fn(uint32_t index);
typedef jcas_status jcas_sim_get_uavs_fn(const struct jcas_sim *sim, struct jcas_uav *uavs, size_t count, size_t struct_size);
typedef jcas_status jcas_sim_get_hotspots_fn(const struct jcas_sim *sim, struct jcas_hotspot *hotspots, size_t count, size_t struct_size);
typedef jcas_status jcas_sim_get_links_fn(const struct jcas_sim *sim, uint8_t *links, size_t count);
typedef jcas_status jcas_sim_get_knowledge_fn(const struct jcas_sim *sim, uint8_t *knowledge, size_t count);
typedef jcas_status jcas_sim_get_detections_fn(const struct jcas_sim *sim, uint8_t *detections, size_t count);
typedef jcas_status jcas_sim_get_throughputs_fn(const struct jcas_sim *sim, double *throughputs, size_t count);
typedef jcas_status jcas_sim_get_visited_fn(const struct jcas_sim *sim, uint8_t *visited, size_t count);
typedef jcas_status jcas_sim_get_search_maps_fn(const struct jcas_sim *sim, uint8_t *maps, size_t count);
typedef jcas_status jcas_sim_get_false_alarms_fn(const struct jcas_sim *sim, uint8_t *alarms, size_t count);
typedef jcas_status jcas_sim_get_false_confirmations_fn(const struct jcas_sim *sim, uint8_t *cells, size_t count);
typedef jcas_status jcas_sim_get_reports_fn(const struct jcas_sim *sim, uint8_t *levels, size_t count);
typedef jcas_status jcas_sim_save_fn(const struct jcas_sim *sim, void *snapshot, size_t size);
typedef jcas_status jcas_sim_load_fn(struct jcas_sim *sim, const void *snapshot, size_t size);
typedef jcas_status jcas_sim_fork_fn(const struct jcas_sim *from, struct jcas_sim *to);
typedef jcas_status jcas_sim_hash_fn(const struct jcas_sim *sim, uint64_t *state_hash);
typedef jcas_status jcas_trace_layout_fn(const struct jcas_model *model, size_t *size, size_t *alignment);
typedef jcas_status jcas_sim_record_fn(struct jcas_sim *sim, uint64_t seed, const struct jcas_recorder *recorder);
typedef jcas_status jcas_sim_record_end_fn(struct jcas_sim *sim);
typedef jcas_status jcas_trace_config_fn(const char *trace, size_t length, struct jcas_config *config, size_t struct_size, char *message, size_t message_capacity);
typedef jcas_status jcas_trace_verify_fn(struct jcas_sim *sim, void *memory, size_t size, const char *trace, size_t length, char *message, size_t message_capacity);
typedef jcas_status jcas_trace_step_fn(struct jcas_sim *sim, void *memory, size_t size, const char *trace, size_t length, size_t *offset, char *message, size_t message_capacity);
typedef jcas_status jcas_batch_new_fn(const struct jcas_model *model, uint32_t environments, uint32_t threads, struct jcas_batch **batch);
typedef jcas_status jcas_batch_layout_fn(const struct jcas_model *model, const struct jcas_batch_options *options, size_t *size, size_t *alignment);
typedef jcas_status jcas_batch_init_fn(void *memory, size_t size, const struct jcas_model *model, const struct jcas_batch_options *options, struct jcas_batch **batch);
typedef jcas_status jcas_batch_free_fn(struct jcas_batch *batch);
typedef jcas_status jcas_batch_reset_fn(struct jcas_batch *batch, const uint64_t *seeds, size_t seed_count, float *observations, size_t observation_count, float *global, size_t global_count);
typedef jcas_status jcas_batch_reset_some_fn(struct jcas_batch *batch, const uint8_t *mask, size_t mask_count, const uint64_t *seeds, size_t seed_count, float *observations, size_t observation_count, float *global, size_t global_count);
typedef jcas_status jcas_batch_step_fn(struct jcas_batch *batch, const float *actions, size_t action_count, int32_t auto_reset, const struct jcas_batch_out *out);
typedef jcas_status jcas_batch_observe_fn(struct jcas_batch *batch, float *observations, size_t observation_count, float *global, size_t global_count);
typedef jcas_status jcas_batch_save_fn(const struct jcas_batch *batch, void *snapshots, size_t size);
typedef jcas_status jcas_batch_load_fn(struct jcas_batch *batch, const void *snapshots, size_t size);
typedef jcas_status jcas_batch_hash_fn(const struct jcas_batch *batch, uint64_t *states_hash);
typedef jcas_status jcas_batch_get_fn(const struct jcas_batch *batch, uint32_t index, struct jcas_sim *sim);
typedef jcas_status jcas_batch_set_fn(struct jcas_batch *batch, uint32_t index, const struct jcas_sim *sim);
typedef jcas_status jcas_batch_message_fn(const struct jcas_batch *batch, char *text, size_t capacity, size_t *length);
typedef jcas_status jcas_policy_layout_fn(const struct jcas_model *model, const uint8_t *file, size_t length, size_t *size, size_t *alignment, char *message, size_t message_capacity);
typedef jcas_status jcas_policy_init_fn(void *memory, size_t size, const struct jcas_model *model, const uint8_t *file, size_t length, struct jcas_policy **policy, char *message, size_t message_capacity);
typedef jcas_status jcas_policy_load_fn(const struct jcas_model *model, const uint8_t *file, size_t length, struct jcas_policy **policy, char *message, size_t message_capacity);
typedef jcas_status jcas_policy_baseline_fn(const struct jcas_model *model, const char *name, const char *pilot, struct jcas_policy **policy, char *message, size_t message_capacity);
typedef const char *jcas_policy_name_fn(uint32_t index);
typedef const char *jcas_policy_summary_fn(uint32_t index);
typedef jcas_status jcas_policy_set_mode_fn(struct jcas_policy *policy, int32_t mode);
typedef jcas_status jcas_policy_act_fn(struct jcas_policy *policy, const struct jcas_sim *sim, float *actions, size_t action_count);
typedef jcas_status jcas_policy_act_batch_fn(struct jcas_policy *policy, const struct jcas_batch *batch, float *actions, size_t action_count);
typedef jcas_status jcas_policy_free_fn(struct jcas_policy *policy);
typedef jcas_status jcas_policy_memory_save_fn(struct jcas_policy *policy, const struct jcas_sim *sim, void *memory, size_t capacity, size_t *length);
typedef jcas_status jcas_policy_memory_load_fn(struct jcas_policy *policy, const struct jcas_sim *sim, const void *memory, size_t size);
typedef jcas_status jcas_policy_memory_save_member_fn(struct jcas_policy *policy, const struct jcas_batch *batch, uint32_t index, void *memory, size_t capacity, size_t *length);
typedef jcas_status jcas_policy_memory_load_member_fn(struct jcas_policy *policy, const struct jcas_batch *batch, uint32_t index, const void *memory, size_t size);
typedef jcas_status jcas_policy_forget_fn(struct jcas_policy *policy);
typedef jcas_status jcas_plan_search_fn(const struct jcas_model *model, const struct jcas_plan_settings *settings, struct jcas_plan **plan, char *message, size_t message_capacity);
typedef jcas_status jcas_plan_tour_fn(const struct jcas_model *model, const struct jcas_cell *hotspots, size_t hotspot_count, const struct jcas_plan_settings *settings, struct jcas_plan **plan, char *message, size_t message_capacity);
typedef jcas_status jcas_plan_from_json_fn(const struct jcas_model *model, const char *text, size_t text_length, struct jcas_plan **plan, char *message, size_t message_capacity);
typedef jcas_status jcas_plan_to_json_fn(const struct jcas_plan *plan, char *text, size_t capacity, size_t *length);
typedef jcas_status jcas_plan_get_info_fn(const struct jcas_plan *plan, struct jcas_plan_info *info);
typedef jcas_status jcas_plan_get_cells_fn(const struct jcas_plan *plan, struct jcas_cell *cells, size_t count);
typedef jcas_status jcas_plan_get_pilot_densities_fn(const struct jcas_plan *plan, double *densities, size_t count);
typedef jcas_status jcas_policy_follow_fn(const struct jcas_model *model, const struct jcas_plan *plan, struct jcas_policy **policy);
typedef jcas_status jcas_plan_free_fn(struct jcas_plan *plan);
typedef jcas_status jcas_batch_fork_fn(struct jcas_batch *batch, const struct jcas_sim *sim, struct jcas_policy *policy, const uint64_t *seeds, size_t seed_count);
typedef jcas_status jcas_batch_rollout_fn(struct jcas_batch *batch, struct jcas_policy *policy, const float *actions, size_t action_count, uint32_t steps, const struct jcas_rollout_out *out);

#endif
