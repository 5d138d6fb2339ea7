"""The C interface as ctypes sees it. Generated from include/jcas.h by generate_abi.py: do not edit."""

from __future__ import annotations

from ctypes import (
    CDLL,
    POINTER,
    Structure,
    c_char_p,
    c_double,
    c_int32,
    c_int64,
    c_size_t,
    c_uint32,
    c_uint64,
    c_void_p,
)

JCAS_VERSION_MAJOR = 0
JCAS_VERSION_MINOR = 1
JCAS_VERSION_PATCH = 0
JCAS_ABI_VERSION = 16777216
JCAS_OK = 0
JCAS_ERROR_NULL = -1
JCAS_ERROR_ALIGNMENT = -2
JCAS_ERROR_LENGTH = -3
JCAS_ERROR_STRUCT_SIZE = -4
JCAS_ERROR_HANDLE = -5
JCAS_ERROR_CONFIG = -6
JCAS_ERROR_ARGUMENT = -7
JCAS_ERROR_NAN = -8
JCAS_ERROR_MODEL_MISMATCH = -9
JCAS_ERROR_OUT_OF_ORDER = -10
JCAS_ERROR_EPISODE_OVER = -11
JCAS_ERROR_CORRUPT = -12
JCAS_ERROR_IN_USE = -13
JCAS_ERROR_RESOURCES = -14
JCAS_ERROR_ABI = -15
JCAS_ERROR_INTERNAL = -16
JCAS_ERROR_FORKED = -17
JCAS_ERROR_SINK = -18
JCAS_ERROR_DIFFERENT = -19
JCAS_ERROR_BUSY = -20
JCAS_MAX_DEPOTS = 16
JCAS_VISIBILITY_KNOWN = 0
JCAS_VISIBILITY_HIDDEN = 1
JCAS_BILLING_ACCEPTED = 0
JCAS_BILLING_NAMEPLATE = 1
JCAS_PAYMENT_ONCE = 0
JCAS_PAYMENT_EVERY_STEP = 1
JCAS_MAPS_OFF = 0
JCAS_MAPS_SHARED = 1
JCAS_DIRECTIONS_OFF = 0
JCAS_DIRECTIONS_SHOWN = 1
JCAS_TAG_OFF = 0
JCAS_TAG_INDEX = 1
JCAS_PHASE_READY = 1
JCAS_PHASE_MOVED = 2
JCAS_PHASE_SENSED = 3
JCAS_PHASE_COMMUNICATED = 4
JCAS_PHASE_TERMINATED = 5
JCAS_PHASE_TRUNCATED = 6
JCAS_OBSERVATION_FIELDS = 21
JCAS_POLICY_DETERMINISTIC = 0
JCAS_POLICY_SAMPLED = 1
JCAS_POLICY_STRATIFIED = 2


class jcas_cell(Structure):
    _fields_ = (
        ("x", c_uint32),
        ("y", c_uint32),
    )


class jcas_config(Structure):
    _fields_ = (
        ("struct_size", c_uint32),
        ("grid_width", c_uint32),
        ("grid_height", c_uint32),
        ("cell_size_m", c_double),
        ("uav_count", c_uint32),
        ("hotspot_count", c_uint32),
        ("horizon_steps", c_uint32),
        ("quorum", c_uint32),
        ("depot_count", c_uint32),
        ("depots", jcas_cell * JCAS_MAX_DEPOTS),
        ("initial_soc_min", c_double),
        ("initial_soc_max", c_double),
        ("target_visibility", c_int32),
        ("neighbour_slots", c_uint32),
        ("carrier_frequency_hz", c_double),
        ("bandwidth_hz", c_double),
        ("transmit_power_dbm", c_double),
        ("transmit_gain_dbi", c_double),
        ("receive_gain_dbi", c_double),
        ("radar_cross_section_dbsm", c_double),
        ("sensing_noise_dbm", c_double),
        ("processing_gain_db", c_double),
        ("comm_load_penalty_db", c_double),
        ("detection_probability", c_double),
        ("false_alarm_probability", c_double),
        ("detection_threshold_db", c_double),
        ("logistic_slope_per_db", c_double),
        ("range_min_m", c_double),
        ("range_resolution_m", c_double),
        ("pilot_density_min", c_double),
        ("pilot_density_max", c_double),
        ("path_loss_exponent", c_double),
        ("comm_noise_dbm", c_double),
        ("reference_spectral_efficiency", c_double),
        ("link_throughput_min", c_double),
        ("step_duration_s", c_double),
        ("battery_capacity_kwh", c_double),
        ("rtb_threshold_kwh", c_double),
        ("charge_power_kw", c_double),
        ("move_energy_kwh", c_double),
        ("hover_energy_kwh", c_double),
        ("sense_energy_kwh", c_double),
        ("comm_energy_kwh", c_double),
        ("renewable_share", c_double),
        ("carbon_intensity_min_kg_per_kwh", c_double),
        ("carbon_intensity_max_kg_per_kwh", c_double),
        ("charge_billing", c_int32),
        ("reward_detect", c_double),
        ("reward_inform", c_double),
        ("inform_payment", c_int32),
        ("reward_complete", c_double),
        ("reward_coverage", c_double),
        ("penalty_energy_per_kwh", c_double),
        ("penalty_carbon_per_kg", c_double),
        ("penalty_revisit", c_double),
        ("penalty_truncation", c_double),
        ("reward_throughput", c_double),
        ("reward_spread", c_double),
        ("shaping_discount", c_double),
        ("shaping_goal_weight", c_double),
        ("shaping_charge_weight", c_double),
        ("search_maps", c_int32),
        ("search_map_radius_m", c_double),
        ("map_window_radius", c_uint32),
        ("map_directions", c_int32),
        ("uav_tag", c_int32),
        ("shaping_unconfirmed_weight", c_double),
        ("sensing_range_m", c_double),
    )


class jcas_model_info(Structure):
    _fields_ = (
        ("struct_size", c_uint32),
        ("uav_count", c_uint32),
        ("hotspot_count", c_uint32),
        ("neighbour_slots", c_uint32),
        ("grid_width", c_uint32),
        ("grid_height", c_uint32),
        ("action_len", c_uint32),
        ("observation_len", c_uint32),
        ("global_len", c_uint32),
        ("reward_len", c_uint32),
        ("snapshot_size", c_uint64),
        ("config_hash", c_uint64),
        ("battery_capacity_uj", c_uint64),
        ("detection_threshold_db", c_double),
    )


class jcas_observation_field(Structure):
    _fields_ = (
        ("offset", c_uint32),
        ("count", c_uint32),
        ("stride", c_uint32),
    )


class jcas_radio(Structure):
    _fields_ = (
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("sensing_snr_db", c_double),
        ("detection_probability", c_double),
        ("comm_snr_db", c_double),
        ("link_throughput", c_double),
    )


class jcas_outcome(Structure):
    _fields_ = (
        ("struct_size", c_uint32),
        ("terminated", c_uint32),
        ("truncated", c_uint32),
        ("reserved", c_uint32),
        ("reward", c_double),
    )


class jcas_episode(Structure):
    _fields_ = (
        ("struct_size", c_uint32),
        ("t", c_uint32),
        ("phase", c_uint32),
        ("terminated", c_uint32),
        ("truncated", c_uint32),
        ("confirmed", c_uint32),
        ("informed", c_uint32),
        ("reserved", c_uint32),
        ("seed", c_uint64),
        ("carbon_intensity_mg_per_kwh", c_uint64),
        ("billed_intensity_mg_per_kwh", c_uint64),
        ("co2_ng", c_uint64),
        ("grid_uj", c_uint64),
        ("mean_throughput", c_double),
    )


class jcas_metrics(Structure):
    _fields_ = (
        ("struct_size", c_uint32),
        ("steps", c_uint32),
        ("terminated", c_uint32),
        ("truncated", c_uint32),
        ("confirmed", c_uint32),
        ("informed", c_uint32),
        ("moves", c_uint64),
        ("return_sum", c_double),
        ("energy_kwh", c_double),
        ("accepted_kwh", c_double),
        ("shortfall_kwh", c_double),
        ("grid_kwh", c_double),
        ("co2_kg", c_double),
        ("throughput_mean", c_double),
        ("pilot_density_mean", c_double),
    )


class jcas_uav(Structure):
    _fields_ = (
        ("x", c_uint32),
        ("y", c_uint32),
        ("moved", c_uint32),
        ("grounded", c_uint32),
        ("returning", c_uint32),
        ("neighbours", c_uint32),
        ("known", c_uint32),
        ("reserved", c_uint32),
        ("battery_uj", c_uint64),
        ("initial_uj", c_uint64),
        ("accepted_uj", c_uint64),
        ("spent_uj", c_uint64),
        ("shortfall_uj", c_uint64),
        ("pilot_density", c_double),
        ("throughput", c_double),
        ("given_uj", c_int64),
    )


class jcas_hotspot(Structure):
    _fields_ = (
        ("x", c_uint32),
        ("y", c_uint32),
        ("confirmed", c_uint32),
        ("informed", c_uint32),
        ("confirmed_at", c_uint32),
        ("informed_at", c_uint32),
    )


class jcas_recorder(Structure):
    _fields_ = (
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("write", c_void_p),
        ("write_context", c_void_p),
        ("policy", c_void_p),
        ("pilot", c_void_p),
        ("memory", c_void_p),
        ("memory_size", c_size_t),
    )


class jcas_batch_options(Structure):
    _fields_ = (
        ("struct_size", c_uint32),
        ("environments", c_uint32),
        ("threads", c_uint32),
        ("reserved", c_uint32),
        ("run", c_void_p),
        ("run_context", c_void_p),
    )


class jcas_batch_out(Structure):
    _fields_ = (
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("observations", c_void_p),
        ("observation_count", c_size_t),
        ("rewards", c_void_p),
        ("reward_count", c_size_t),
        ("terminated", c_void_p),
        ("terminated_count", c_size_t),
        ("truncated", c_void_p),
        ("truncated_count", c_size_t),
        ("global", c_void_p),
        ("global_count", c_size_t),
        ("components", c_void_p),
        ("component_count", c_size_t),
        ("final_observations", c_void_p),
        ("final_observation_count", c_size_t),
        ("final_global", c_void_p),
        ("final_global_count", c_size_t),
        ("final_metrics", c_void_p),
        ("final_metrics_count", c_size_t),
        ("metrics_size", c_size_t),
        ("uav_rewards", c_void_p),
        ("uav_reward_count", c_size_t),
    )


def declare(library: CDLL) -> None:
    """Give every function its types."""
    library.jcas_version.argtypes = ()
    library.jcas_version.restype = c_char_p
    library.jcas_abi_version.argtypes = ()
    library.jcas_abi_version.restype = c_uint32
    library.jcas_abi_check.argtypes = (c_uint32,)
    library.jcas_abi_check.restype = c_int32
    library.jcas_status_string.argtypes = (c_int32,)
    library.jcas_status_string.restype = c_char_p
    library.jcas_config_default.argtypes = (POINTER(jcas_config), c_size_t)
    library.jcas_config_default.restype = c_int32
    library.jcas_config_preset.argtypes = (c_char_p, c_size_t, POINTER(jcas_config), c_size_t, c_char_p, c_size_t)
    library.jcas_config_preset.restype = c_int32
    library.jcas_config_from_toml.argtypes = (c_char_p, c_size_t, POINTER(jcas_config), c_size_t, c_char_p, c_size_t)
    library.jcas_config_from_toml.restype = c_int32
    library.jcas_config_from_json.argtypes = (c_char_p, c_size_t, POINTER(jcas_config), c_size_t, c_char_p, c_size_t)
    library.jcas_config_from_json.restype = c_int32
    library.jcas_config_validate.argtypes = (POINTER(jcas_config), c_char_p, c_size_t)
    library.jcas_config_validate.restype = c_int32
    library.jcas_config_hash.argtypes = (POINTER(jcas_config), c_void_p)
    library.jcas_config_hash.restype = c_int32
    library.jcas_config_to_json.argtypes = (POINTER(jcas_config), c_char_p, c_size_t, c_void_p)
    library.jcas_config_to_json.restype = c_int32
    library.jcas_config_to_toml.argtypes = (POINTER(jcas_config), c_char_p, c_size_t, c_void_p)
    library.jcas_config_to_toml.restype = c_int32
    library.jcas_config_fields.argtypes = (c_char_p, c_size_t, c_void_p)
    library.jcas_config_fields.restype = c_int32
    library.jcas_model_layout.argtypes = (POINTER(jcas_config), c_void_p, c_void_p, c_char_p, c_size_t)
    library.jcas_model_layout.restype = c_int32
    library.jcas_model_init.argtypes = (c_void_p, c_size_t, POINTER(jcas_config), POINTER(c_void_p), c_char_p, c_size_t)
    library.jcas_model_init.restype = c_int32
    library.jcas_model_new.argtypes = (POINTER(jcas_config), POINTER(c_void_p), c_char_p, c_size_t)
    library.jcas_model_new.restype = c_int32
    library.jcas_model_free.argtypes = (c_void_p,)
    library.jcas_model_free.restype = c_int32
    library.jcas_model_get_info.argtypes = (c_void_p, POINTER(jcas_model_info))
    library.jcas_model_get_info.restype = c_int32
    library.jcas_model_observation_fields.argtypes = (c_void_p, POINTER(jcas_observation_field), c_size_t, c_size_t)
    library.jcas_model_observation_fields.restype = c_int32
    library.jcas_observation_field_name.argtypes = (c_uint32,)
    library.jcas_observation_field_name.restype = c_char_p
    library.jcas_model_get_config.argtypes = (c_void_p, POINTER(jcas_config), c_size_t)
    library.jcas_model_get_config.restype = c_int32
    library.jcas_model_get_radio.argtypes = (c_void_p, c_uint32, c_uint32, c_double, POINTER(jcas_radio))
    library.jcas_model_get_radio.restype = c_int32
    library.jcas_sim_layout.argtypes = (c_void_p, c_void_p, c_void_p)
    library.jcas_sim_layout.restype = c_int32
    library.jcas_sim_init.argtypes = (c_void_p, c_size_t, c_void_p, POINTER(c_void_p))
    library.jcas_sim_init.restype = c_int32
    library.jcas_sim_new.argtypes = (c_void_p, POINTER(c_void_p))
    library.jcas_sim_new.restype = c_int32
    library.jcas_sim_free.argtypes = (c_void_p,)
    library.jcas_sim_free.restype = c_int32
    library.jcas_sim_reset.argtypes = (c_void_p, c_uint64)
    library.jcas_sim_reset.restype = c_int32
    library.jcas_derive_seed.argtypes = (c_uint64, c_uint64)
    library.jcas_derive_seed.restype = c_uint64
    library.jcas_sim_step.argtypes = (c_void_p, c_void_p, c_size_t, POINTER(jcas_outcome))
    library.jcas_sim_step.restype = c_int32
    library.jcas_sim_observe.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_observe.restype = c_int32
    library.jcas_sim_observe_global.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_observe_global.restype = c_int32
    library.jcas_sim_message.argtypes = (c_void_p, c_char_p, c_size_t, c_void_p)
    library.jcas_sim_message.restype = c_int32
    library.jcas_sim_step_begin.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_step_begin.restype = c_int32
    library.jcas_sim_set_positions.argtypes = (c_void_p, POINTER(jcas_cell), c_size_t)
    library.jcas_sim_set_positions.restype = c_int32
    library.jcas_sim_step_sense.argtypes = (c_void_p,)
    library.jcas_sim_step_sense.restype = c_int32
    library.jcas_sim_ground.argtypes = (c_void_p, c_uint32)
    library.jcas_sim_ground.restype = c_int32
    library.jcas_sim_confirm_hotspot.argtypes = (c_void_p, c_uint32)
    library.jcas_sim_confirm_hotspot.restype = c_int32
    library.jcas_sim_step_sense_with.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_step_sense_with.restype = c_int32
    library.jcas_sim_step_communicate.argtypes = (c_void_p,)
    library.jcas_sim_step_communicate.restype = c_int32
    library.jcas_sim_step_communicate_with.argtypes = (c_void_p, c_void_p, c_size_t, c_void_p, c_size_t)
    library.jcas_sim_step_communicate_with.restype = c_int32
    library.jcas_sim_step_end.argtypes = (c_void_p, POINTER(jcas_outcome))
    library.jcas_sim_step_end.restype = c_int32
    library.jcas_sim_set_hotspots.argtypes = (c_void_p, POINTER(jcas_cell), c_size_t)
    library.jcas_sim_set_hotspots.restype = c_int32
    library.jcas_sim_move_hotspot.argtypes = (c_void_p, c_uint32, c_uint32, c_uint32)
    library.jcas_sim_move_hotspot.restype = c_int32
    library.jcas_sim_set_starts.argtypes = (c_void_p, POINTER(jcas_cell), c_size_t)
    library.jcas_sim_set_starts.restype = c_int32
    library.jcas_sim_set_battery.argtypes = (c_void_p, c_uint32, c_uint64)
    library.jcas_sim_set_battery.restype = c_int32
    library.jcas_sim_set_batteries.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_set_batteries.restype = c_int32
    library.jcas_sim_get_episode.argtypes = (c_void_p, POINTER(jcas_episode))
    library.jcas_sim_get_episode.restype = c_int32
    library.jcas_sim_get_metrics.argtypes = (c_void_p, POINTER(jcas_metrics))
    library.jcas_sim_get_metrics.restype = c_int32
    library.jcas_sim_get_rewards.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_get_rewards.restype = c_int32
    library.jcas_sim_uav_rewards.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_uav_rewards.restype = c_int32
    library.jcas_sim_uav_reward_components.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_uav_reward_components.restype = c_int32
    library.jcas_reward_name.argtypes = (c_uint32,)
    library.jcas_reward_name.restype = c_char_p
    library.jcas_sim_get_uavs.argtypes = (c_void_p, POINTER(jcas_uav), c_size_t, c_size_t)
    library.jcas_sim_get_uavs.restype = c_int32
    library.jcas_sim_get_hotspots.argtypes = (c_void_p, POINTER(jcas_hotspot), c_size_t, c_size_t)
    library.jcas_sim_get_hotspots.restype = c_int32
    library.jcas_sim_get_links.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_get_links.restype = c_int32
    library.jcas_sim_get_knowledge.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_get_knowledge.restype = c_int32
    library.jcas_sim_get_detections.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_get_detections.restype = c_int32
    library.jcas_sim_get_throughputs.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_get_throughputs.restype = c_int32
    library.jcas_sim_get_visited.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_get_visited.restype = c_int32
    library.jcas_sim_get_search_maps.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_get_search_maps.restype = c_int32
    library.jcas_sim_save.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_save.restype = c_int32
    library.jcas_sim_load.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_sim_load.restype = c_int32
    library.jcas_sim_fork.argtypes = (c_void_p, c_void_p)
    library.jcas_sim_fork.restype = c_int32
    library.jcas_sim_hash.argtypes = (c_void_p, c_void_p)
    library.jcas_sim_hash.restype = c_int32
    library.jcas_trace_layout.argtypes = (c_void_p, c_void_p, c_void_p)
    library.jcas_trace_layout.restype = c_int32
    library.jcas_sim_record.argtypes = (c_void_p, c_uint64, POINTER(jcas_recorder))
    library.jcas_sim_record.restype = c_int32
    library.jcas_sim_record_end.argtypes = (c_void_p,)
    library.jcas_sim_record_end.restype = c_int32
    library.jcas_trace_config.argtypes = (c_char_p, c_size_t, POINTER(jcas_config), c_size_t, c_char_p, c_size_t)
    library.jcas_trace_config.restype = c_int32
    library.jcas_trace_verify.argtypes = (c_void_p, c_void_p, c_size_t, c_char_p, c_size_t, c_char_p, c_size_t)
    library.jcas_trace_verify.restype = c_int32
    library.jcas_trace_step.argtypes = (c_void_p, c_void_p, c_size_t, c_char_p, c_size_t, c_void_p, c_char_p, c_size_t)
    library.jcas_trace_step.restype = c_int32
    library.jcas_batch_new.argtypes = (c_void_p, c_uint32, c_uint32, POINTER(c_void_p))
    library.jcas_batch_new.restype = c_int32
    library.jcas_batch_layout.argtypes = (c_void_p, POINTER(jcas_batch_options), c_void_p, c_void_p)
    library.jcas_batch_layout.restype = c_int32
    library.jcas_batch_init.argtypes = (c_void_p, c_size_t, c_void_p, POINTER(jcas_batch_options), POINTER(c_void_p))
    library.jcas_batch_init.restype = c_int32
    library.jcas_batch_free.argtypes = (c_void_p,)
    library.jcas_batch_free.restype = c_int32
    library.jcas_batch_reset.argtypes = (c_void_p, c_void_p, c_size_t, c_void_p, c_size_t, c_void_p, c_size_t)
    library.jcas_batch_reset.restype = c_int32
    library.jcas_batch_reset_some.argtypes = (c_void_p, c_void_p, c_size_t, c_void_p, c_size_t, c_void_p, c_size_t, c_void_p, c_size_t)
    library.jcas_batch_reset_some.restype = c_int32
    library.jcas_batch_step.argtypes = (c_void_p, c_void_p, c_size_t, c_int32, POINTER(jcas_batch_out))
    library.jcas_batch_step.restype = c_int32
    library.jcas_batch_observe.argtypes = (c_void_p, c_void_p, c_size_t, c_void_p, c_size_t)
    library.jcas_batch_observe.restype = c_int32
    library.jcas_batch_save.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_batch_save.restype = c_int32
    library.jcas_batch_load.argtypes = (c_void_p, c_void_p, c_size_t)
    library.jcas_batch_load.restype = c_int32
    library.jcas_batch_hash.argtypes = (c_void_p, c_void_p)
    library.jcas_batch_hash.restype = c_int32
    library.jcas_batch_get.argtypes = (c_void_p, c_uint32, c_void_p)
    library.jcas_batch_get.restype = c_int32
    library.jcas_batch_set.argtypes = (c_void_p, c_uint32, c_void_p)
    library.jcas_batch_set.restype = c_int32
    library.jcas_batch_message.argtypes = (c_void_p, c_char_p, c_size_t, c_void_p)
    library.jcas_batch_message.restype = c_int32
    library.jcas_policy_layout.argtypes = (c_void_p, c_void_p, c_size_t, c_void_p, c_void_p, c_char_p, c_size_t)
    library.jcas_policy_layout.restype = c_int32
    library.jcas_policy_init.argtypes = (c_void_p, c_size_t, c_void_p, c_void_p, c_size_t, POINTER(c_void_p), c_char_p, c_size_t)
    library.jcas_policy_init.restype = c_int32
    library.jcas_policy_load.argtypes = (c_void_p, c_void_p, c_size_t, POINTER(c_void_p), c_char_p, c_size_t)
    library.jcas_policy_load.restype = c_int32
    library.jcas_policy_baseline.argtypes = (c_void_p, c_char_p, c_char_p, POINTER(c_void_p), c_char_p, c_size_t)
    library.jcas_policy_baseline.restype = c_int32
    library.jcas_policy_set_mode.argtypes = (c_void_p, c_int32)
    library.jcas_policy_set_mode.restype = c_int32
    library.jcas_policy_act.argtypes = (c_void_p, c_void_p, c_void_p, c_size_t)
    library.jcas_policy_act.restype = c_int32
    library.jcas_policy_act_batch.argtypes = (c_void_p, c_void_p, c_void_p, c_size_t)
    library.jcas_policy_act_batch.restype = c_int32
    library.jcas_policy_free.argtypes = (c_void_p,)
    library.jcas_policy_free.restype = c_int32
