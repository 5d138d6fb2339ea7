/* jcas: deterministic simulation of UAV fleets that sense and communicate with one OFDM waveform.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * A whole episode:
 *
 *     jcas_config config;
 *     jcas_model *model;
 *     jcas_sim *sim;
 *     float actions[2 * 5] = {0};
 *     jcas_outcome outcome = {.struct_size = sizeof outcome};
 *     jcas_config_default(&config, sizeof config);
 *     config.uav_count = 5;
 *     if (jcas_model_new(&config, &model, NULL, 0) || jcas_sim_new(model, &sim)) return 1;
 *     if (jcas_sim_reset(sim, 42)) return 1;
 *     while (!outcome.terminated && !outcome.truncated)
 *         if (jcas_sim_step(sim, actions, 2 * 5, &outcome)) return 1;
 *     return jcas_sim_free(sim) || jcas_model_free(model);
 *
 * Five kinds of object, each behind an opaque handle:
 *   jcas_model   a validated configuration and its tables; it never changes.
 *   jcas_sim     one state of a model: one running episode.
 *   jcas_batch   many states of a model, stepped together.
 *   jcas_policy  a controller of a fleet: a trained network, a baseline or a follower of a plan.
 *   jcas_plan    trajectories of a fleet for the least expected time; it never changes.
 *
 * Order of calls:  reset -> step -> step -> ... -> (terminated or truncated) -> reset
 * A step by parts: step_begin -> [set_positions, ground, confirm_hotspot] -> step_sense[_with]
 *                  -> step_communicate[_with] -> step_end
 * Between steps: set_battery, move_hotspot; at t = 0 also set_starts, set_hotspots, set_batteries.
 * A trace: record in place of reset, ..., record_end.
 *
 * The rules that hold for every function stand at the end of this file: statuses, memory, pointers,
 * structs, messages, threads, numbers. docs/c.md is a tutorial.
 */

#ifndef JCAS_H
#define JCAS_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

/* Precedes every declaration. Define JCAS_SHARED in a Windows program that uses the shared
 * library. */
#ifndef JCAS_API
#if defined(_WIN32) && defined(JCAS_SHARED)
#define JCAS_API __declspec(dllimport)
#else
#define JCAS_API
#endif
#endif

/* Makes the compiler warn if a status is not read. Define it empty to turn the warning off. */
#ifndef JCAS_NODISCARD
#if defined(__GNUC__)
#define JCAS_NODISCARD __attribute__((warn_unused_result))
#else
#define JCAS_NODISCARD
#endif
#endif

/* Leaves a real field of jcas_config to be derived from the others. */
#define JCAS_DERIVED ((double)NAN)

/** @defgroup constants Constants
 *  @{ */

/// The version of the library that this header belongs to.
#define JCAS_VERSION_MAJOR 0

/// See JCAS_VERSION_MAJOR.
#define JCAS_VERSION_MINOR 1

/// See JCAS_VERSION_MAJOR.
#define JCAS_VERSION_PATCH 0

/// The version of the interface that this header declares: 16777216 * major + 65536 * minor. It is
/// counted apart from the library's version, as most releases do not change it. Version 1.0 is the
/// first release; no release serves headers of major version 0.
#define JCAS_ABI_VERSION 16777216

/** @} */

/** @defgroup status Statuses
 *  @{ */

/// The call succeeded.
#define JCAS_OK 0

/// A pointer that must not be NULL is NULL.
#define JCAS_ERROR_NULL (-1)

/// A pointer is not aligned for its type.
#define JCAS_ERROR_ALIGNMENT (-2)

/// A buffer, or memory for a handle, has the wrong size.
#define JCAS_ERROR_LENGTH (-3)

/// A `struct_size` is not a size that this library knows.
#define JCAS_ERROR_STRUCT_SIZE (-4)

/// A handle is not of the right kind, was freed, or was moved.
#define JCAS_ERROR_HANDLE (-5)

/// A configuration field is outside its range, or a text is not a configuration.
#define JCAS_ERROR_CONFIG (-6)

/// An argument is outside its range.
#define JCAS_ERROR_ARGUMENT (-7)

/// An action component is NaN, or a network output is not finite.
#define JCAS_ERROR_NAN (-8)

/// A state and a model, or two states, have different configurations.
#define JCAS_ERROR_MODEL_MISMATCH (-9)

/// A function was called in the wrong phase of a step.
#define JCAS_ERROR_OUT_OF_ORDER (-10)

/// The episode has ended: reset before the next step.
#define JCAS_ERROR_EPISODE_OVER (-11)

/// The bytes are not a snapshot of this model, not a policy, not a plan, or not a trace.
#define JCAS_ERROR_CORRUPT (-12)

/// The model still has simulations, batches or policies, or memory given to ..._init holds a living
/// handle.
#define JCAS_ERROR_IN_USE (-13)

/// The system did not provide memory or threads.
#define JCAS_ERROR_RESOURCES (-14)

/// The program was compiled for an incompatible version of this library.
#define JCAS_ERROR_ABI (-15)

/// The library has a fault; please report it. Reset or free the handle of the call.
#define JCAS_ERROR_INTERNAL (-16)

/// The batch has threads, which a forked process does not have. Build another batch there.
#define JCAS_ERROR_FORKED (-17)

/// The caller's sink refused a part of a trace.
#define JCAS_ERROR_SINK (-18)

/// The library does not reproduce a trace.
#define JCAS_ERROR_DIFFERENT (-19)

/// Another call is using the object, on another thread or further up the stack.
#define JCAS_ERROR_BUSY (-20)

/// What the policy remembers does not belong to the state, or to the policy.
#define JCAS_ERROR_MEMORY (-21)

/** @} */

/** @defgroup values Values of fields and arguments
 *  @{ */

/// The largest number of depots in a configuration.
#define JCAS_MAX_DEPOTS 16

/// UAVs observe the position of every hotspot, as in the paper.
#define JCAS_VISIBILITY_KNOWN 0

/// UAVs observe the positions of the hotspots that they know, and must search for the others.
#define JCAS_VISIBILITY_HIDDEN 1

/// Charging bills what the battery accepted.
#define JCAS_BILLING_ACCEPTED 0

/// Charging bills the charger's rating whenever a UAV is on a depot, as in the paper.
#define JCAS_BILLING_NAMEPLATE 1

/// An informed hotspot pays at the step at which it becomes informed.
#define JCAS_PAYMENT_ONCE 0

/// An informed hotspot pays at that step and every later one, as in the paper.
#define JCAS_PAYMENT_EVERY_STEP 1

/// UAVs keep no search maps.
#define JCAS_MAPS_OFF 0

/// Each UAV keeps a map of the cells that it knows to be searched; maps spread with knowledge.
#define JCAS_MAPS_SHARED 1

/// Observations do not show how much is unsearched in each direction.
#define JCAS_DIRECTIONS_OFF 0

/// Observations show how much is unsearched in each of eight directions.
#define JCAS_DIRECTIONS_SHOWN 1

/// Observations do not distinguish UAVs in one cell.
#define JCAS_TAG_OFF 0

/// Observations end with the UAV's index over N - 1.
#define JCAS_TAG_INDEX 1

/// The pilot density adds nothing to the sensing SNR, as in the paper.
#define JCAS_PILOT_GAIN_NONE 0

/// The radar integrates its pilots coherently: the SNR gains 10 log10(ρ/ρ_max) dB.
#define JCAS_PILOT_GAIN_COHERENT 1

/// The probability of detection is the paper's logistic function of the margin.
#define JCAS_CURVE_LOGISTIC 0

/// The probability of detection is that of a Swerling-1 echo in one look.
#define JCAS_CURVE_SWERLING1 1

/// The probability of detection is a table over the range.
#define JCAS_CURVE_TABLE 2

/// The quorum counts the positive detections of one step, as in the paper.
#define JCAS_QUORUM_STEP 0

/// The quorum counts the UAVs that have detected the hotspot in the episode so far.
#define JCAS_QUORUM_EPISODE 1

/// A UAV learns the hotspots that it detected and that are confirmed.
#define JCAS_LEARNED_CONFIRMED 0

/// A UAV learns all hotspots that it detected.
#define JCAS_LEARNED_ALL 1

/// All UAVs start at the first depot.
#define JCAS_START_DEPOT 0

/// Each UAV starts in a cell drawn from the whole grid.
#define JCAS_START_RANDOM 1

/// The bins of u_dir are up, down, left, right, stay.
#define JCAS_MOTIONS_UDLRS 0

/// The bins of u_dir are up, left, stay, right, down.
#define JCAS_MOTIONS_SYMMETRIC 1

/// The largest number of points of a detection table.
#define JCAS_MAX_DETECTION_POINTS 64

/// A step may begin, whole or by parts. Next: jcas_sim_step or jcas_sim_step_begin.
#define JCAS_PHASE_READY 1

/// The UAVs have acted and moved. Next: jcas_sim_set_positions or jcas_sim_step_sense.
#define JCAS_PHASE_MOVED 2

/// The UAVs have sensed. Next: jcas_sim_step_communicate or jcas_sim_step_communicate_with.
#define JCAS_PHASE_SENSED 3

/// The UAVs have communicated. Next: jcas_sim_step_end.
#define JCAS_PHASE_COMMUNICATED 4

/// The episode has ended with every hotspot informed. Next: jcas_sim_reset.
#define JCAS_PHASE_TERMINATED 5

/// The horizon has ended the episode. Next: jcas_sim_reset.
#define JCAS_PHASE_TRUNCATED 6

/// The number of fields of an observation, which jcas_observation_field_name names.
#define JCAS_OBSERVATION_FIELDS 25

/// Motion up, +y, as the first component of an action with JCAS_MOTIONS_UDLRS, like the four below.
/// With JCAS_MOTIONS_SYMMETRIC these values mean up, left, stay, right, down in ascending order.
#define JCAS_MOVE_UP (-0.8f)

/// Motion down, -y.
#define JCAS_MOVE_DOWN (-0.4f)

/// Motion left, -x.
#define JCAS_MOVE_LEFT 0.0f

/// Motion right, +x.
#define JCAS_MOVE_RIGHT 0.4f

/// No motion.
#define JCAS_MOVE_STAY 0.8f

/// Actions are the most likely motion and the mean pilot density. UAVs that choose sequentially
/// stay on a depot to charge. They sample where they would turn back without a new confirmation.
#define JCAS_POLICY_DETERMINISTIC 0

/// Actions are drawn from the network's distribution; the draws follow from the seed of the
/// episode, the step and the UAV.
#define JCAS_POLICY_SAMPLED 1

/** @} */

/** @defgroup handles Handles
 *  @{ */

/// M environments of one model, with their working memory and optional worker threads. One thread
/// at a time may use a batch.
typedef struct jcas_batch jcas_batch;

/// A validated configuration with its precomputed tables. It never changes, so any number of
/// threads may use one model at once.
typedef struct jcas_model jcas_model;

/// A plan of an episode: the cell and the pilot density of each UAV in each step. It never changes,
/// and it outlives its model.
typedef struct jcas_plan jcas_plan;

/// A controller of a fleet for one model: a trained network or a baseline. One thread at a time may
/// use it; a model may have several policies.
typedef struct jcas_policy jcas_policy;

/// One state of a model, with its working memory. One thread at a time may use it, except that
/// functions that take it as const may run concurrently.
typedef struct jcas_sim jcas_sim;

/// The result of a call: JCAS_OK or a negative JCAS_ERROR_... code.
typedef int32_t jcas_status;

/** @} */

/** @defgroup structs Structs
 *  @{ */

/// A cell of the grid: x in 0..W, y in 0..H.
typedef struct jcas_cell {
    /// Column.
    uint32_t x;
    /// Row; up is +y.
    uint32_t y;
} jcas_cell;

/// A point of a detection table.
typedef struct jcas_detection_point {
    /// Distance between UAV and hotspot. [m, 0 to 1e6]
    double range_m;
    /// Probability of detection (P_d) at the highest pilot density. [probability, above 0 and below
    /// 1]
    double probability;
} jcas_detection_point;

/// The configuration of a model. Fill it by jcas_config_default or another function that fills it,
/// then change fields. Each field states [unit, legal range; default]. Symbols are those of the
/// paper.
typedef struct jcas_config {
    /// sizeof(jcas_config).
    uint32_t struct_size;
    /// Cells of the grid along x (W). [cells, 1 to 1024; default 12]
    uint32_t grid_width;
    /// Cells of the grid along y (H). [cells, 1 to 1024; default 12]
    uint32_t grid_height;
    /// Side of a square cell (d). [m, 0.001 to 1e6; default 50]
    double cell_size_m;
    /// UAVs in the fleet (N). [UAVs, 1 to 4096; default 10]
    uint32_t uav_count;
    /// Waste hotspots to find (n). [hotspots, 1 to 4096; default 5]
    uint32_t hotspot_count;
    /// Steps after which an unfinished episode is truncated (T_max). [steps, 1 to 1000000; default
    /// 100]
    uint32_t horizon_steps;
    /// Positive detections that confirm a hotspot (θ), in one step by default; above N none ever
    /// is. [UAVs, 1 to 4096; default 3]
    uint32_t quorum;
    /// Number of depots, 0 to JCAS_MAX_DEPOTS. 0 (default): one depot, at (W/2, H/2).
    uint32_t depot_count;
    /// Cells with a depot; the fleet starts at the first. Those beyond depot_count are not read.
    struct jcas_cell depots[JCAS_MAX_DEPOTS];
    /// Lowest state of charge at the start; drawn per UAV, uniformly. [fraction, 0 to 1; default 1]
    double initial_soc_min;
    /// Highest state of charge at the start. [fraction, 0 to 1; default 1]
    double initial_soc_max;
    /// What UAVs see of hotspots that they do not know: JCAS_VISIBILITY_KNOWN (default) or
    /// JCAS_VISIBILITY_HIDDEN.
    int32_t target_visibility;
    /// Neighbours in an observation, nearest first; at most N - 1 are ever used. [UAVs, 0 to 4095;
    /// default 4095]
    uint32_t neighbour_slots;
    /// Carrier frequency (f_c). [Hz, 1e6 to 1e13; default 5.8e9]
    double carrier_frequency_hz;
    /// Bandwidth of the waveform (B). [Hz, 1e3 to 1e12; default 100e6]
    double bandwidth_hz;
    /// Transmit power of a UAV (P_t). [dBm, -100 to 100; default 20]
    double transmit_power_dbm;
    /// Transmit antenna gain (G_t). [dBi, -100 to 100; default 2]
    double transmit_gain_dbi;
    /// Receive antenna gain (G_r). [dBi, -100 to 100; default 2]
    double receive_gain_dbi;
    /// Radar cross section of a hotspot (σ_j). [dBsm, -100 to 100; default 0]
    double radar_cross_section_dbsm;
    /// Noise power of the radar receiver (P_n). [dBm, -200 to 100; default -90]
    double sensing_noise_dbm;
    /// Processing gain of coherent OFDM combining (G_proc). [dB, -100 to 100; default 8]
    double processing_gain_db;
    /// Loss of sensing SNR per unit of communication load (α_JCAS). [dB, 0 to 20; default 1]
    double comm_load_penalty_db;
    /// Single-pulse probability of detection that defines the threshold (Albersheim's equation).
    /// [probability, 0.1 to 0.9; default 0.9]
    double detection_probability;
    /// Single-pulse probability of false alarm (P_fa) that defines the threshold, or the curve
    /// JCAS_CURVE_SWERLING1. JCAS_CURVE_LOGISTIC takes 1e-7 to 1e-3. [probability, 1e-12 to 0.1;
    /// default 1e-6]
    double false_alarm_probability;
    /// Detection threshold (γ_det); JCAS_DERIVED: by Albersheim's equation. [dB, -300 to 300;
    /// default JCAS_DERIVED]
    double detection_threshold_db;
    /// Slope of the logistic detection curve (κ). [1/dB, 0 to 10; default 0.25]
    double logistic_slope_per_db;
    /// Distances below this count as this, for radar and link (R_min); JCAS_DERIVED: half a cell.
    /// [m, 0.001 to 1e6; default JCAS_DERIVED]
    double range_min_m;
    /// Range resolution (δ) in the penalty 10 log10(1 + δ/R); JCAS_DERIVED: c/(2B); 0: no penalty.
    /// [m, 0 to 1e6; default JCAS_DERIVED]
    double range_resolution_m;
    /// Lowest pilot density (ρ_min). [fraction, 0 to 1; default 0.01]
    double pilot_density_min;
    /// Highest pilot density (ρ_max). [fraction, 0.0001 to 1; default 0.30]
    double pilot_density_max;
    /// Exponent of the log-distance path loss (n). [dimensionless, 0.5 to 8; default 2]
    double path_loss_exponent;
    /// Noise power of the communication receiver (P_n,comm). [dBm, -200 to 100; default -90]
    double comm_noise_dbm;
    /// Spectral efficiency that counts as throughput 1. [bit/s/Hz, 0.001 to 1000; default 6]
    double reference_spectral_efficiency;
    /// Normalised throughput that a link needs in both directions (η_link). [normalised, 0 to 1000;
    /// default 1]
    double link_throughput_min;
    /// Duration of a step (Δt). [s, 0.001 to 86400; default 10]
    double step_duration_s;
    /// Battery capacity (B_max). [kWh, 1e-6 to 100; default 0.20]
    double battery_capacity_kwh;
    /// A battery below this at the start of a step sends the UAV to the nearest depot. 0 turns the
    /// rule off. [kWh, 0 to 100; default 0.04]
    double rtb_threshold_kwh;
    /// Charging power at a depot (r_ch). [kW, 0 to 10000; default 0.30]
    double charge_power_kw;
    /// Energy of a step that changes the cell (e_move). [kWh, 0 to 1; default 8e-4]
    double move_energy_kwh;
    /// Energy of a step in place. [kWh, 0 to 1; default 0]
    double hover_energy_kwh;
    /// Energy of sensing at the highest pilot density for a step (e_sense). [kWh, 0 to 1; default
    /// 2e-4]
    double sense_energy_kwh;
    /// Energy of communicating with the whole waveform for a step (e_comm). [kWh, 0 to 1; default
    /// 5e-5]
    double comm_energy_kwh;
    /// Share of renewable energy in charging (ρ_RE). [fraction, 0 to 1; default 0.1]
    double renewable_share;
    /// Lowest carbon intensity of grid energy. [kg/kWh, 0 to 10; default 0.25]
    double carbon_intensity_min_kg_per_kwh;
    /// Highest carbon intensity of grid energy. [kg/kWh, 0 to 10; default 0.40]
    double carbon_intensity_max_kg_per_kwh;
    /// What charging bills: JCAS_BILLING_ACCEPTED (default) or JCAS_BILLING_NAMEPLATE.
    int32_t charge_billing;
    /// Reward of a confirmation (α_det). [reward, -1e6 to 1e6; default 7]
    double reward_detect;
    /// Reward of an informed hotspot (α_inf). [reward, -1e6 to 1e6; default 4]
    double reward_inform;
    /// When an informed hotspot pays: JCAS_PAYMENT_ONCE (default) or JCAS_PAYMENT_EVERY_STEP.
    int32_t inform_payment;
    /// Reward of completion (α_comp). [reward, -1e6 to 1e6; default 10]
    double reward_complete;
    /// Reward of covering the whole grid for the first time (α_cov). [reward, -1e6 to 1e6; default
    /// 0.5]
    double reward_coverage;
    /// Penalty of energy spent (η_e). [reward/kWh, -1e6 to 1e6; default 0.2]
    double penalty_energy_per_kwh;
    /// Penalty of carbon emitted (η_c). [reward/kg, -1e6 to 1e6; default 0.1]
    double penalty_carbon_per_kg;
    /// Penalty of a move into a cell visited before (ξ_rev). [reward, -1e6 to 1e6; default 0.01]
    double penalty_revisit;
    /// Penalty at the horizon (ξ_trunc). [reward, -1e6 to 1e6; default 0.4]
    double penalty_truncation;
    /// Reward of mean normalised throughput (ζ_comm). [reward, -1e6 to 1e6; default 0.5]
    double reward_throughput;
    /// Reward of knowledge spread (ζ_spread). [reward, -1e6 to 1e6; default 0.1]
    double reward_spread;
    /// Discount of the shaping potentials (γ_s). [dimensionless, 0 to 1; default 0.95]
    double shaping_discount;
    /// Weight of the distance-to-hotspot potential (w_g). [reward, 0 to 1e6; default 1]
    double shaping_goal_weight;
    /// Weight of the carbon-aware charging potential (w_c). [reward, 0 to 1e6; default 0.1]
    double shaping_charge_weight;
    /// Whether each UAV keeps a map of the cells that it knows to have been looked at:
    /// JCAS_MAPS_OFF (default) or JCAS_MAPS_SHARED.
    int32_t search_maps;
    /// A UAV has looked at the cells whose centre is at most this far from its own. [m, 0 to 1e6;
    /// default 100]
    double search_map_radius_m;
    /// Observations show the map this many cells around the UAV; 0: not at all. [cells, 0 to 32;
    /// default 0]
    uint32_t map_window_radius;
    /// Whether observations show how much is unsearched in eight directions: JCAS_DIRECTIONS_OFF
    /// (default) or JCAS_DIRECTIONS_SHOWN.
    int32_t map_directions;
    /// What tells UAVs in one cell apart: JCAS_TAG_OFF (default) or JCAS_TAG_INDEX.
    int32_t uav_tag;
    /// Weight of each unconfirmed hotspot in the potential of w_g (w_u), in longest ways over the
    /// grid. From 1 on, a confirmation never lowers the potential. [longest ways, 0 to 1000;
    /// default 1]
    double shaping_unconfirmed_weight;
    /// The threshold (γ_det) is the sensing SNR at this distance, before the load's penalty. An
    /// explicit detection_threshold_db takes precedence. JCAS_DERIVED: Albersheim's equation gives
    /// the threshold. [m, 0.001 to 1e6; default JCAS_DERIVED]
    double sensing_range_m;
    /// What the pilot density adds to the sensing SNR: JCAS_PILOT_GAIN_NONE (default) or
    /// JCAS_PILOT_GAIN_COHERENT.
    int32_t pilot_gain;
    /// Probability of detection: JCAS_CURVE_LOGISTIC (default) or JCAS_CURVE_SWERLING1 over the
    /// sensing SNR, or JCAS_CURVE_TABLE over the range. The last two refuse a threshold and a
    /// sensing range, and JCAS_CURVE_SWERLING1 refuses a slope.
    int32_t detection_curve;
    /// Probability of a false alarm, for each step and cell of a UAV's footprint that holds no
    /// hotspot. 0 stands for no false alarms. [probability, 0 to 0.5; default 0]
    double false_alarm_per_cell;
    /// A UAV may raise false alarms in the cells whose centre is at most this far from its own
    /// (footprint). JCAS_DERIVED: the sensing range, or the range at which the probability of
    /// detection is 0.5 at pilot_density_max. Refused without false alarms. [m, 0 to 1e6; default
    /// JCAS_DERIVED]
    double sensing_footprint_m;
    /// Reward of a false confirmation: at least θ UAVs see a hotspot in one cell that holds none.
    /// [reward, -1e6 to 1e6; default 0]
    double reward_false_confirmation;
    /// Levels of the reports that UAVs share. Level l has the cells in which one UAV saw a hotspot,
    /// true or false, in at least l steps. 0 stands for no reports. Refused without false alarms.
    /// [levels, 0 to 3; default 0]
    uint32_t report_levels;
    /// Number of reported cells in an observation, nearest first. Refused without reports.
    /// [cells, 0 to 64; default 0]
    uint32_t report_slots;
    /// Number of points of the detection table, 1 to JCAS_MAX_DETECTION_POINTS with
    /// JCAS_CURVE_TABLE, otherwise 0 (default).
    uint32_t detection_point_count;
    /// Points of ascending range, whose P_d does not rise. Between two of them the logit of P_d is
    /// linear, and beyond the ends it is held. The pilot gain and the load's penalty move the logit
    /// by logistic_slope_per_db. Points beyond detection_point_count are not read.
    struct jcas_detection_point detection_table[JCAS_MAX_DETECTION_POINTS];
    /// Positive detections that count toward the quorum: JCAS_QUORUM_STEP (default) or
    /// JCAS_QUORUM_EPISODE. A false confirmation needs the same quorum.
    int32_t quorum_window;
    /// Hotspots that a UAV learns by its own detection: JCAS_LEARNED_CONFIRMED (default) or
    /// JCAS_LEARNED_ALL. The episode terminates when all UAVs know all hotspots and each hotspot is
    /// confirmed.
    int32_t learned_detections;
    /// Cells in which UAVs start: JCAS_START_DEPOT (default) or JCAS_START_RANDOM.
    int32_t start_cells;
    /// Order of the motions over the five bins of u_dir: JCAS_MOTIONS_UDLRS (default) or
    /// JCAS_MOTIONS_SYMMETRIC.
    int32_t motion_map;
} jcas_config;

/// The sizes and constants of a model, which determine the lengths of all buffers.
typedef struct jcas_model_info {
    /// sizeof(jcas_model_info); set it before the call.
    uint32_t struct_size;
    /// UAVs (N).
    uint32_t uav_count;
    /// Hotspots (n).
    uint32_t hotspot_count;
    /// Neighbours in an observation.
    uint32_t neighbour_slots;
    /// Cells of the grid along x (W).
    uint32_t grid_width;
    /// Cells of the grid along y (H).
    uint32_t grid_height;
    /// Floats of the actions of a step: 2 N.
    uint32_t action_len;
    /// Floats of one UAV's observation: 11 + 4 n + 3 neighbour_slots, plus the entries of
    /// map_window_radius, map_directions, uav_tag and report_slots.
    uint32_t observation_len;
    /// Floats of the global state: 6 N + 4 n + 4.
    uint32_t global_len;
    /// Components of a reward: 12.
    uint32_t reward_len;
    /// Bytes of a snapshot.
    uint64_t snapshot_size;
    /// Fingerprint of the configuration.
    uint64_t config_hash;
    /// Capacity of a battery, in microjoules.
    uint64_t battery_capacity_uj;
    /// Detection threshold, in dB.
    double detection_threshold_db;
} jcas_model_info;

/// A field of one UAV's observation: `count` entries at offset, offset + stride, offset + 2 stride
/// and so on.
typedef struct jcas_observation_field {
    /// Index of the first entry.
    uint32_t offset;
    /// Number of entries: one, or one for each hotspot, slot, cell or direction. It is 0
    /// if the configuration leaves the field out.
    uint32_t count;
    /// Distance from one entry to the next, in floats.
    uint32_t stride;
} jcas_observation_field;

/// The radar and link budget between two cells.
typedef struct jcas_radio {
    /// sizeof(jcas_radio); set it before the call.
    uint32_t struct_size;
    /// Always 0.
    uint32_t reserved;
    /// Sensing SNR without the penalty of the communication load, in dB.
    double sensing_snr_db;
    /// Probability that a UAV detects a hotspot in one step.
    double detection_probability;
    /// Communication SNR, in dB.
    double comm_snr_db;
    /// Normalised throughput of a UAV toward another.
    double link_throughput;
} jcas_radio;

/// The outcome of a step.
typedef struct jcas_outcome {
    /// sizeof(jcas_outcome); set it before the call.
    uint32_t struct_size;
    /// 1 if every hotspot is confirmed and informed, else 0.
    uint32_t terminated;
    /// 1 if the horizon ended the episode before that, else 0.
    uint32_t truncated;
    /// Cells without a hotspot that a quorum confirmed in this step.
    uint32_t false_confirmations;
    /// The team reward, the same for every UAV.
    double reward;
} jcas_outcome;

/// The scalars of a state.
typedef struct jcas_episode {
    /// sizeof(jcas_episode); set it before the call.
    uint32_t struct_size;
    /// Steps begun since the reset.
    uint32_t t;
    /// The phase of the step, which decides what may be called next: JCAS_PHASE_READY and so on.
    uint32_t phase;
    /// 1 if every hotspot is confirmed and informed, else 0.
    uint32_t terminated;
    /// 1 if the horizon ended the episode before that, else 0.
    uint32_t truncated;
    /// Hotspots confirmed.
    uint32_t confirmed;
    /// Hotspots that all UAVs know.
    uint32_t informed;
    /// Always 0.
    uint32_t reserved;
    /// Seed of the episode.
    uint64_t seed;
    /// Carbon intensity that the coming step will be billed with, in mg/kWh.
    uint64_t carbon_intensity_mg_per_kwh;
    /// Carbon intensity that the last step was billed with, in mg/kWh; 0 before the first.
    uint64_t billed_intensity_mg_per_kwh;
    /// Carbon emitted in the episode, in nanograms.
    uint64_t co2_ng;
    /// Grid energy billed in the episode, in microjoules.
    uint64_t grid_uj;
    /// Mean normalised throughput of the present graph, over all UAVs.
    double mean_throughput;
} jcas_episode;

/// The metrics of an episode, so far or at its end.
typedef struct jcas_metrics {
    /// sizeof(jcas_metrics); set it before the call.
    uint32_t struct_size;
    /// Steps taken.
    uint32_t steps;
    /// 1 if every hotspot is confirmed and informed (the mission succeeded), else 0.
    uint32_t terminated;
    /// 1 if the horizon ended the episode before that, else 0.
    uint32_t truncated;
    /// Hotspots confirmed.
    uint32_t confirmed;
    /// Hotspots that all UAVs know.
    uint32_t informed;
    /// Moves between cells, over all UAVs.
    uint64_t moves;
    /// Undiscounted return.
    double return_sum;
    /// Energy spent by the fleet, in kWh.
    double energy_kwh;
    /// Energy accepted from chargers, in kWh.
    double accepted_kwh;
    /// Energy demanded beyond the charge of the batteries, in kWh.
    double shortfall_kwh;
    /// Grid energy billed, in kWh.
    double grid_kwh;
    /// Carbon emitted, in kg.
    double co2_kg;
    /// Mean over the steps of the fleet's mean normalised throughput.
    double throughput_mean;
    /// Mean over steps and UAVs of the pilot density, a fraction.
    double pilot_density_mean;
    /// Cells without a hotspot that a quorum confirmed.
    uint64_t false_confirmations;
} jcas_metrics;

/// The state of a UAV.
typedef struct jcas_uav {
    /// Column of its cell.
    uint32_t x;
    /// Row of its cell.
    uint32_t y;
    /// 1 if it changed its cell in the last step, else 0.
    uint32_t moved;
    /// 1 if its battery was empty at the start of the last step, else 0.
    uint32_t grounded;
    /// 1 if a low battery sent it toward a depot in the last step, else 0.
    uint32_t returning;
    /// Neighbours in the radio graph.
    uint32_t neighbours;
    /// Hotspots that it knows.
    uint32_t known;
    /// Always 0.
    uint32_t reserved;
    /// Charge, in microjoules: initial + accepted + given - spent.
    uint64_t battery_uj;
    /// Charge at the start of the episode, in microjoules.
    uint64_t initial_uj;
    /// Energy accepted from chargers, in microjoules.
    uint64_t accepted_uj;
    /// Energy spent, in microjoules.
    uint64_t spent_uj;
    /// Energy demanded beyond the charge of the battery, in microjoules.
    uint64_t shortfall_uj;
    /// Pilot density, a fraction.
    double pilot_density;
    /// Mean normalised throughput toward its neighbours; 0 without any.
    double throughput;
    /// Net energy that jcas_sim_set_battery has added to the battery, in microjoules; negative if
    /// removed.
    int64_t given_uj;
} jcas_uav;

/// The state of a hotspot.
typedef struct jcas_hotspot {
    /// Column of its cell.
    uint32_t x;
    /// Row of its cell.
    uint32_t y;
    /// 1 if it is confirmed, else 0.
    uint32_t confirmed;
    /// 1 if all UAVs know it, else 0.
    uint32_t informed;
    /// Step at which it was confirmed; 0 before.
    uint32_t confirmed_at;
    /// Step at which all UAVs know it; 0 before.
    uint32_t informed_at;
} jcas_hotspot;

/// A function of the caller that takes the next `count` bytes of a trace. `context` is the pointer
/// from jcas_recorder. It returns 0, or another value if it could not take the bytes; then it is
/// not called again.
typedef int32_t (*jcas_write)(const char *bytes, size_t count, void *context);

/// The sink and the working memory of a recording. Everything that it points to, except the names,
/// must stay valid until the recording ends.
typedef struct jcas_recorder {
    /// sizeof(jcas_recorder).
    uint32_t struct_size;
    /// Reserved; set it to 0.
    uint32_t reserved;
    /// The function that takes the trace; not NULL.
    jcas_write write;
    /// The pointer that is passed to `write`.
    void *write_context;
    /// The name of the policy for the header of the trace, in UTF-8; NULL means "host".
    const char *policy;
    /// The name of the pilot mode for the header of the trace, in UTF-8; NULL means "host".
    const char *pilot;
    /// Working memory with at least the size and alignment of jcas_trace_layout; not NULL.
    void *memory;
    /// The size of `memory` in bytes.
    size_t memory_size;
} jcas_recorder;

/// One task of a batch step. It is called with its own task_context and an index below `count`.
typedef void (*jcas_task)(void *task_context, uint32_t index);

/// A function of the caller that runs the tasks of a step. It calls `task(task_context, index)`
/// once for each index from 0 to count - 1, in any order and on any threads. It returns when all of
/// these calls have returned. `context` is the pointer from jcas_batch_options. The step itself
/// runs tasks that were left out; if none was run, the step returns JCAS_ERROR_ARGUMENT.
typedef void (*jcas_run_tasks)(jcas_task task, void *task_context, uint32_t count, void *context);

/// The options of jcas_batch_init.
typedef struct jcas_batch_options {
    /// sizeof(jcas_batch_options).
    uint32_t struct_size;
    /// Number of environments (M), at least 1.
    uint32_t environments;
    /// Threads that step at once, including the caller's. 1 starts no thread. 0 means one for each
    /// processor. With `run` it is the number of tasks of a step, and no thread is started.
    uint32_t threads;
    /// Reserved; set it to 0.
    uint32_t reserved;
    /// The function that runs the tasks of a step, or NULL for the library's own threads.
    jcas_run_tasks run;
    /// The pointer that is passed to `run`.
    void *run_context;
} jcas_batch_options;

/// The buffers that a batch step writes, for M environments. Each pointer is followed by its
/// number of elements. Optional buffers may be NULL with a count of 0. No buffer may overlap
/// another buffer or the actions.
typedef struct jcas_batch_out {
    /// sizeof(jcas_batch_out).
    uint32_t struct_size;
    /// Reserved; set it to 0.
    uint32_t reserved;
    /// M * uav_count * observation_len: the observation of each UAV. After an automatic reset it is
    /// the first one of the new episode.
    float *observations;
    /// Elements of observations.
    size_t observation_count;
    /// M: the team reward.
    float *rewards;
    /// Elements of rewards.
    size_t reward_count;
    /// M: 1 where the step ended the episode because every hotspot is confirmed and informed, else
    /// 0.
    uint8_t *terminated;
    /// Elements of terminated.
    size_t terminated_count;
    /// M: 1 where the step ended the episode at the horizon, else 0.
    uint8_t *truncated;
    /// Elements of truncated.
    size_t truncated_count;
    /// M * global_len: the global state; optional.
    float *global;
    /// Elements of global.
    size_t global_count;
    /// M * reward_len: the components of each reward; optional.
    double *components;
    /// Elements of components.
    size_t component_count;
    /// M * uav_count * observation_len: the last observation of each episode that was reset; other
    /// rows are not written; optional.
    float *final_observations;
    /// Elements of final_observations.
    size_t final_observation_count;
    /// M * global_len: the last global state of each episode that was reset; other rows are not
    /// written; optional.
    float *final_global;
    /// Elements of final_global.
    size_t final_global_count;
    /// M: the metrics of each episode that ended; other elements are not written; optional.
    struct jcas_metrics *final_metrics;
    /// Elements of final_metrics.
    size_t final_metrics_count;
    /// sizeof(jcas_metrics), or 0 without final_metrics.
    size_t metrics_size;
    /// M * uav_count: the reward of each UAV, whose mean over a fleet is the team reward; optional.
    float *uav_rewards;
    /// Elements of uav_rewards.
    size_t uav_reward_count;
} jcas_batch_out;

/// A function of the caller that hears of the progress of a planning. `iterations` counts the moves
/// tried so far; it is 0 while initial trajectories are evaluated. `best_steps` is the expected
/// time of the best plan so far, infinite before the first one. `context` is the pointer from
/// jcas_plan_settings. It returns 0 to go on; another value ends the planning early, with the best
/// plan so far.
typedef int32_t (*jcas_plan_progress)(uint64_t iterations, double best_steps, void *context);

/// The length and the seed of an annealing. A plan depends on them and on the configuration only,
/// unless `progress` ends it early.
typedef struct jcas_plan_settings {
    /// sizeof(jcas_plan_settings).
    uint32_t struct_size;
    /// Reserved; set it to 0.
    uint32_t reserved;
    /// Moves that the annealing tries. A search of ten UAVs takes some 200 000 in a second.
    uint64_t iterations;
    /// Seed of the annealing.
    uint64_t seed;
    /// The function that hears of the progress; may be NULL.
    jcas_plan_progress progress;
    /// The pointer that is passed to `progress`.
    void *progress_context;
} jcas_plan_settings;

/// The size of a plan and what it promises.
typedef struct jcas_plan_info {
    /// sizeof(jcas_plan_info); set it before the call.
    uint32_t struct_size;
    /// UAVs (N).
    uint32_t uav_count;
    /// Steps of the trajectories; the fleet stays in its last cells after them.
    uint32_t step_count;
    /// 1 if the annealing ended before the requested number of moves, else 0.
    uint32_t stopped;
    /// Fingerprint of the configuration, as jcas_config_hash.
    uint64_t config_hash;
    /// Seed of the annealing.
    uint64_t seed;
    /// Moves that the annealing tried.
    uint64_t iterations;
    /// Expected steps until the episode ends; one without success counts with its horizon.
    double expected_steps;
    /// Expected steps until every hotspot is confirmed.
    double expected_confirmed_steps;
    /// Probability that the episode ends before the horizon.
    double success;
    /// Expected steps of the trajectories that the annealing began with.
    double start_steps;
    /// A lower bound on the expected steps of every plan without feedback.
    double bound_steps;
} jcas_plan_info;

/// The buffers that a rollout writes, for M environments. Each pointer is followed by its number of
/// elements. Optional buffers may be NULL with a count of 0. No buffer may overlap another buffer
/// or the actions.
typedef struct jcas_rollout_out {
    /// sizeof(jcas_rollout_out).
    uint32_t struct_size;
    /// Reserved; set it to 0.
    uint32_t reserved;
    /// M: the sum of the team rewards of the steps made.
    double *returns;
    /// Elements of returns.
    size_t return_count;
    /// M: the number of steps made, which is smaller where an episode ended; optional.
    uint32_t *steps;
    /// Elements of steps.
    size_t step_count;
    /// M: 1 where the episode has ended because every hotspot is confirmed and informed, else 0;
    /// optional.
    uint8_t *terminated;
    /// Elements of terminated.
    size_t terminated_count;
    /// M: 1 where the episode has ended at the horizon, else 0; optional.
    uint8_t *truncated;
    /// Elements of truncated.
    size_t truncated_count;
    /// M: the metrics of the episode up to the last state; optional.
    struct jcas_metrics *metrics;
    /// Elements of metrics.
    size_t metrics_count;
    /// sizeof(jcas_metrics), or 0 without metrics.
    size_t metrics_size;
    /// M * snapshot_size: the last states, in the format of jcas_batch_save; optional.
    void *snapshots;
    /// Bytes of snapshots.
    size_t snapshots_size;
} jcas_rollout_out;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/** @} */

/** @defgroup version Versions and words of a status
 *  @{ */

/// Returns the version of the library that runs, such as "0.1.0", as a static string.
/// Threads: any.
JCAS_API const char *jcas_version(void);

/// Returns the version of the interface of the library that runs.
/// Threads: any.
JCAS_API uint32_t jcas_abi_version(void);

/// Checks that the library that runs serves a program compiled with this header:
/// `jcas_abi_check(JCAS_ABI_VERSION)`. It does if the major versions are equal and the header's
/// minor version is not later. Make this call first: other calls cannot distinguish another version
/// from a wrong size.
/// Threads: any.
/// Statuses: ABI.
JCAS_API JCAS_NODISCARD jcas_status jcas_abi_check(uint32_t header_abi_version);

/// Returns the meaning of a status in English.
///
/// The result is a static string and never NULL, also for values that are not a status.
/// Threads: any.
JCAS_API const char *jcas_status_string(jcas_status status);

/** @} */

/** @defgroup config Configurations
 *  @{ */

/// Fills `config` with the default, the preset "mission". Pass sizeof(jcas_config) as
/// `struct_size`.
///
/// `config`: not NULL.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE.
JCAS_API jcas_status jcas_config_default(struct jcas_config *config, size_t struct_size);

/// Fills `config` with a preset: "mission", "paper", "search" or "isac". "paper" takes every
/// equation exactly as in the paper. "search" has hidden hotspots and shared search maps. "isac" is
/// a search with coherent pilots, a fluctuating echo, false alarms and reports.
///
/// `name`: `name_length` bytes, not NULL, no terminating zero needed. `message`: see the rules
/// below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_config_preset(const char *name,
                               size_t name_length,
                               struct jcas_config *config,
                               size_t struct_size,
                               char *message,
                               size_t message_capacity);

/// Fills `config` from a TOML text. It may name a `preset` (else "mission"); every other key is a
/// field and replaces the preset's value; unknown keys are errors. The result is validated.
///
/// `text`: `text_length` bytes of UTF-8, not NULL, no terminating zero needed. `message`: see the
/// rules below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_config_from_toml(const char *text,
                                  size_t text_length,
                                  struct jcas_config *config,
                                  size_t struct_size,
                                  char *message,
                                  size_t message_capacity);

/// Fills `config` from a JSON object, with the rules of jcas_config_from_toml. The value null
/// restores a field to being derived.
///
/// `text`, `message`: as for jcas_config_from_toml.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_config_from_json(const char *text,
                                  size_t text_length,
                                  struct jcas_config *config,
                                  size_t struct_size,
                                  char *message,
                                  size_t message_capacity);

/// Checks a configuration. It returns JCAS_OK or JCAS_ERROR_CONFIG, with a message that names the
/// field, its value and what is allowed.
///
/// `config`: not NULL, struct_size set. `message`: see the rules below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, CONFIG.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_config_validate(const struct jcas_config *config,
                                 char *message,
                                 size_t message_capacity);

/// Writes the fingerprint of a legal configuration, which is part of every state and snapshot.
///
/// `config`, `hash`: not NULL, struct_size set.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, CONFIG.
JCAS_API jcas_status jcas_config_hash(const struct jcas_config *config, uint64_t *hash);

/// Writes a legal configuration as JSON text, which jcas_config_from_json reads back. Derived
/// fields are absent.
///
/// `text`: `capacity` bytes, or NULL with a capacity of 0 to ask for the length. `length`: not
/// NULL; receives the length without the terminating zero. `capacity` must be at least one more;
/// otherwise the call writes only the length and returns JCAS_ERROR_LENGTH.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_config_to_json(const struct jcas_config *config,
                                char *text,
                                size_t capacity,
                                size_t *length);

/// Writes a legal configuration as TOML text, which jcas_config_from_toml reads back. Derived
/// fields are absent.
///
/// `text`, `capacity`, `length`: as for jcas_config_to_json.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_config_to_toml(const struct jcas_config *config,
                                char *text,
                                size_t capacity,
                                size_t *length);

/// Writes the fields of the configuration as JSON text: a list of objects with name, unit, low,
/// high, default (null: derived) and doc.
///
/// `text`, `capacity`, `length`: as for jcas_config_to_json.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH.
JCAS_API JCAS_NODISCARD jcas_status jcas_config_fields(char *text, size_t capacity, size_t *length);

/** @} */

/** @defgroup model Models
 *  @{ */

/// Writes the size and alignment of the memory that jcas_model_init needs.
///
/// `config`, `size`, `alignment`: not NULL. `size` in bytes. `message`: see the rules below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, CONFIG, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_model_layout(const struct jcas_config *config,
                              size_t *size,
                              size_t *alignment,
                              char *message,
                              size_t message_capacity);

/// Builds a model in the caller's memory, which must not move until jcas_model_free.
///
/// `memory`: at least the size and alignment of jcas_model_layout; not NULL; the caller's.
/// `config`: not NULL; not needed after the call. `model`: not NULL; receives the handle.
/// `message`: see the rules below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG, IN_USE, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_model_init(void *memory,
                            size_t size,
                            const struct jcas_config *config,
                            struct jcas_model **model,
                            char *message,
                            size_t message_capacity);

/// Builds a model in memory from the system. jcas_model_free ends it.
///
/// `config`: not NULL; not needed after the call. `model`: not NULL; receives the handle.
/// `message`: see the rules below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, CONFIG, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_model_new(const struct jcas_config *config,
                           struct jcas_model **model,
                           char *message,
                           size_t message_capacity);

/// Ends a model. Memory of jcas_model_init belongs to the caller again. NULL is allowed and does
/// nothing. It returns JCAS_ERROR_IN_USE until every simulation, batch and policy of the model has
/// been freed.
///
/// Threads: none may be using the model.
/// Statuses: NULL, ALIGNMENT, HANDLE, IN_USE.
JCAS_API jcas_status jcas_model_free(struct jcas_model *model);

/// Writes the sizes and constants of a model.
///
/// `model`, `info`: not NULL; info->struct_size set.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE.
JCAS_API
jcas_status jcas_model_get_info(const struct jcas_model *model,
                                struct jcas_model_info *info);

/// Writes the position of each field in the observation of one UAV. Together the fields cover every
/// entry exactly once.
///
/// `model`, `fields`: not NULL. `count`: JCAS_OBSERVATION_FIELDS. `struct_size`:
/// sizeof(jcas_observation_field).
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_model_observation_fields(const struct jcas_model *model,
                                          struct jcas_observation_field *fields,
                                          size_t count,
                                          size_t struct_size);

/// Returns the name of a field of an observation, such as "soc" or "hotspot_dx". It is a static
/// string, or NULL for an index of JCAS_OBSERVATION_FIELDS or more.
/// Threads: any.
JCAS_API const char *jcas_observation_field_name(uint32_t index);

/// Writes the configuration of a model.
///
/// `model`, `config`: not NULL. `struct_size`: sizeof(jcas_config).
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE.
JCAS_API
jcas_status jcas_model_get_config(const struct jcas_model *model,
                                  struct jcas_config *config,
                                  size_t struct_size);

/// Writes the radar and link budget over an offset of (dx, dy) cells at a pilot density of the
/// sender.
///
/// `model`, `radio`: not NULL; radio->struct_size set. `dx` below W, `dy` below H, `pilot_density`
/// from 0 to 1, or JCAS_ERROR_ARGUMENT.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE, ARGUMENT.
JCAS_API
jcas_status jcas_model_get_radio(const struct jcas_model *model,
                                 uint32_t dx,
                                 uint32_t dy,
                                 double pilot_density,
                                 struct jcas_radio *radio);

/** @} */

/** @defgroup sim Simulations
 *  @{ */

/// Writes the size and alignment of the memory that jcas_sim_init needs.
///
/// `model`, `size`, `alignment`: not NULL. `size` in bytes.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_layout(const struct jcas_model *model,
                            size_t *size,
                            size_t *alignment);

/// Builds a simulation in the caller's memory, which must not move until jcas_sim_free. It is at t
/// = 0 of seed 0.
///
/// `memory`: at least the size and alignment of jcas_sim_layout; not NULL; the caller's. `model`:
/// not NULL; must not be freed before the simulation. `sim`: not NULL; receives the handle.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, IN_USE, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_init(void *memory,
                          size_t size,
                          const struct jcas_model *model,
                          struct jcas_sim **sim);

/// Builds a simulation in memory from the system, at t = 0 of seed 0. jcas_sim_free ends it.
///
/// `model`: not NULL; must not be freed before the simulation. `sim`: not NULL; receives the
/// handle.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_new(const struct jcas_model *model,
                         struct jcas_sim **sim);

/// Ends a simulation. Memory of jcas_sim_init belongs to the caller again. NULL is allowed and does
/// nothing.
///
/// Threads: none may be using the simulation.
/// Statuses: NULL, ALIGNMENT, HANDLE.
JCAS_API jcas_status jcas_sim_free(struct jcas_sim *sim);

/// Begins the episode of a seed, which determines every random draw of the episode.
///
/// `sim`: not NULL.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE.
JCAS_API JCAS_NODISCARD jcas_status jcas_sim_reset(struct jcas_sim *sim, uint64_t seed);

/// Derives the seed with the given index from a seed. Episode k of a campaign of the command line
/// has the seed jcas_derive_seed(seed, k). An automatic reset uses index 0.
///
/// Threads: any.
JCAS_API uint64_t jcas_derive_seed(uint64_t seed, uint64_t index);

/// Performs one whole step.
///
/// `actions`: a pair per UAV, action_len floats; not NULL. The first of a pair chooses the motion
/// by five equal bins of -1 to 1, in the order of motion_map. The second chooses the pilot density,
/// from its minimum at -1 to its maximum at 1. Both are clipped; NaN is refused. `outcome`: not
/// NULL, struct_size set.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, NAN, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_step(struct jcas_sim *sim,
                          const float *actions,
                          size_t action_count,
                          struct jcas_outcome *outcome);

/// Writes the observation of each UAV: uav_count rows of observation_len floats.
///
/// Each row begins with the UAV itself: x/(W-1), y/(H-1), state of charge, pilot density scaled to
/// 0 to 1, mean throughput. For each hotspot follow dx/(W-1), dy/(H-1), confirmed, known. For each
/// neighbour slot, nearest first, follow present, dx/(W-1), dy/(H-1). Then follow neighbours/(N-1),
/// carbon intensity from 0 to 1, depot distance/(W+H-2), confirmed/n, informed/n, t/T_max. Fields
/// that the configuration adds come last: jcas_model_observation_fields lists all of them.
///
/// `sim`, `observations`: not NULL. `count`: uav_count * observation_len.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_observe(struct jcas_sim *sim,
                             float *observations,
                             size_t count);

/// Writes the global state, for a centralised critic: global_len floats.
///
/// For each UAV: x/(W-1), y/(H-1), state of charge, pilot density, mean throughput, fraction of
/// hotspots known. For each hotspot: x/(W-1), y/(H-1), confirmed, fraction of UAVs that know it.
/// The last four are carbon intensity, confirmed/n, informed/n, t/T_max.
///
/// `sim`, `global`: not NULL.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_observe_global(const struct jcas_sim *sim,
                                    float *global,
                                    size_t count);

/// Writes why the last call that took this simulation without const was refused. The text names the
/// value and what is allowed; it is empty if that call succeeded.
///
/// `text`, `capacity`, `length`: as for jcas_config_to_json.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_message(const struct jcas_sim *sim,
                             char *text,
                             size_t capacity,
                             size_t *length);

/** @} */

/** @defgroup parts A step by parts, for a host simulator
 *  @{ */

/// Part 1 of a step: actions, return to base, move. Next: jcas_sim_set_positions (optional), then
/// jcas_sim_step_sense.
///
/// `sim`, `actions`: as for jcas_sim_step.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, NAN, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_step_begin(struct jcas_sim *sim,
                                const float *actions,
                                size_t action_count);

/// Sets the positions of the UAVs, in place of the kernel's own motion. A UAV has moved if its cell
/// differs from the one before the step, at any distance.
///
/// `sim`, `cells`: not NULL. `count`: uav_count.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_set_positions(struct jcas_sim *sim,
                                   const struct jcas_cell *cells,
                                   size_t count);

/// Part 2 of a step: sense and learn. Next: jcas_sim_step_communicate or
/// jcas_sim_step_communicate_with.
///
/// `sim`: not NULL.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API JCAS_NODISCARD jcas_status jcas_sim_step_sense(struct jcas_sim *sim);

/// Keeps a UAV from flying, sensing and communicating in this step, at any charge of its battery.
/// It stays in its cell of before the step and uses no energy. Call it between jcas_sim_step_begin
/// and jcas_sim_step_sense; if jcas_sim_set_positions is called too, call that first.
///
/// `sim`: not NULL. `uav`: below uav_count, or JCAS_ERROR_ARGUMENT.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API JCAS_NODISCARD jcas_status jcas_sim_ground(struct jcas_sim *sim, uint32_t uav);

/// Confirms a hotspot in this step without a quorum of detections. Call it between
/// jcas_sim_step_begin and jcas_sim_step_sense. UAVs that then detect the hotspot know it. Nothing
/// changes if it was already confirmed.
///
/// `sim`: not NULL. `hotspot`: below hotspot_count, or JCAS_ERROR_ARGUMENT.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_confirm_hotspot(struct jcas_sim *sim,
                                     uint32_t hotspot);

/// Part 2 of a step with the host's detections, in place of jcas_sim_step_sense.
///
/// `sim`, `detections`: not NULL. `count`: uav_count * hotspot_count, a row for each UAV; any value
/// but 0 is a detection. Detections by grounded UAVs are ignored, and those of confirmed hotspots
/// that the UAV knows, as the kernel makes no draw for them.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_step_sense_with(struct jcas_sim *sim,
                                     const uint8_t *detections,
                                     size_t count);

/// Part 3 of a step: communicate over the graph of the kernel's link budget. Next:
/// jcas_sim_step_end.
///
/// `sim`: not NULL.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API JCAS_NODISCARD jcas_status jcas_sim_step_communicate(struct jcas_sim *sim);

/// Part 3 of a step over the host's graph, in place of jcas_sim_step_communicate.
///
/// `links`: a uav_count * uav_count matrix, row by row; any value but 0 is a link; not NULL. It
/// must be symmetric; the diagonal and links of grounded UAVs are ignored. `throughput`: uav_count
/// numbers from 0 to 1e9, the mean normalised throughput of each UAV toward its neighbours. NULL
/// with a count of 0 takes it from the kernel's link budget. A UAV without neighbours has 0 in
/// either case.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_step_communicate_with(struct jcas_sim *sim,
                                           const uint8_t *links,
                                           size_t link_count,
                                           const double *throughput,
                                           size_t throughput_count);

/// Part 4 of a step: account for energy, charge, carbon and reward, and end the episode if it is
/// over.
///
/// `sim`, `outcome`: not NULL, struct_size set.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_step_end(struct jcas_sim *sim,
                              struct jcas_outcome *outcome);

/// Sets the cells of the hotspots, in place of the drawn ones. The cells must be distinct and
/// without a depot. Allowed at t = 0 only.
///
/// `sim`, `cells`: not NULL. `count`: hotspot_count.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_set_hotspots(struct jcas_sim *sim,
                                  const struct jcas_cell *cells,
                                  size_t count);

/// Moves a hotspot between steps. Its confirmation and the UAVs that know it do not change.
///
/// `sim`: not NULL. `hotspot`: below hotspot_count. `x`, `y`: a cell of the grid without a depot or
/// another hotspot. Anything else is JCAS_ERROR_ARGUMENT.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_move_hotspot(struct jcas_sim *sim,
                                  uint32_t hotspot,
                                  uint32_t x,
                                  uint32_t y);

/// Sets the cells in which the UAVs start, in place of the first depot. Allowed at t = 0 only.
///
/// `sim`, `cells`: not NULL. `count`: uav_count.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_set_starts(struct jcas_sim *sim,
                                const struct jcas_cell *cells,
                                size_t count);

/// Sets the present charge of a battery, in microjoules, between steps. 0 grounds the UAV from the
/// next step on. The difference is added to given_uj of jcas_uav.
///
/// `sim`: not NULL. `uav`: below uav_count, `charge_uj`: at most battery_capacity_uj, or
/// JCAS_ERROR_ARGUMENT.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_set_battery(struct jcas_sim *sim,
                                 uint32_t uav,
                                 uint64_t charge_uj);

/// Sets the initial charge of each battery, in microjoules, in place of the drawn one. Allowed at t
/// = 0 only.
///
/// `sim`, `charges_uj`: not NULL. `count`: uav_count.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_set_batteries(struct jcas_sim *sim,
                                   const uint64_t *charges_uj,
                                   size_t count);

/** @} */

/** @defgroup queries Queries of a simulation
 *  @{ */

/// Writes the time, the phase and the totals of the episode.
///
/// `sim`, `episode`: not NULL; episode->struct_size set.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE.
JCAS_API jcas_status jcas_sim_get_episode(const struct jcas_sim *sim, struct jcas_episode *episode);

/// Writes the metrics of the episode so far.
///
/// `sim`, `metrics`: not NULL; metrics->struct_size set.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE.
JCAS_API jcas_status jcas_sim_get_metrics(const struct jcas_sim *sim, struct jcas_metrics *metrics);

/// Writes the components of the last reward. The reward is their sum, from the first to the last.
///
/// `sim`, `components`: not NULL. `count`: reward_len.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_rewards(const struct jcas_sim *sim,
                                 double *components,
                                 size_t count);

/// Writes the reward of each UAV in the last step, or 0 before the first. The mean of these rewards
/// is the team reward. Detections, informing, completion, truncation and the spread of knowledge
/// are shared. Coverage, energy, carbon and revisits are the UAV's own, times N. Throughput and
/// potentials are the UAV's own in place of the fleet's means.
///
/// `sim`, `rewards`: not NULL. `count`: uav_count.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_uav_rewards(const struct jcas_sim *sim,
                                 double *rewards,
                                 size_t count);

/// Writes the components of jcas_sim_uav_rewards: a row of reward_len for each UAV, named by
/// jcas_reward_name. The sum of a row, from left to right, is the UAV's reward.
///
/// `sim`, `components`: not NULL. `count`: uav_count * reward_len.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_uav_reward_components(const struct jcas_sim *sim,
                                           double *components,
                                           size_t count);

/// Returns the name of a component of the reward: a static string, or NULL for an index of
/// reward_len or more.
/// Threads: any.
JCAS_API const char *jcas_reward_name(uint32_t index);

/// Writes the state of every UAV.
///
/// `sim`, `uavs`: not NULL. `count`: uav_count. `struct_size`: sizeof(jcas_uav).
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE.
JCAS_API
jcas_status jcas_sim_get_uavs(const struct jcas_sim *sim,
                              struct jcas_uav *uavs,
                              size_t count,
                              size_t struct_size);

/// Writes the state of every hotspot.
///
/// `sim`, `hotspots`: not NULL. `count`: hotspot_count. `struct_size`: sizeof(jcas_hotspot).
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE.
JCAS_API
jcas_status jcas_sim_get_hotspots(const struct jcas_sim *sim,
                                  struct jcas_hotspot *hotspots,
                                  size_t count,
                                  size_t struct_size);

/// Writes the radio graph as a symmetric matrix, row by row: 1 where two UAVs are neighbours, else
/// 0.
///
/// `sim`, `links`: not NULL. `count`: uav_count * uav_count.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API jcas_status jcas_sim_get_links(const struct jcas_sim *sim, uint8_t *links, size_t count);

/// Writes the knowledge matrix: 1 where a UAV (row) knows a hotspot (column), else 0.
///
/// `sim`, `knowledge`: not NULL. `count`: uav_count * hotspot_count.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_knowledge(const struct jcas_sim *sim,
                                   uint8_t *knowledge,
                                   size_t count);

/// Writes the detections of the last sensing: 1 where a UAV (row) detected a hotspot (column), else
/// 0. A UAV does not sense hotspots that it already knows.
///
/// `sim`, `detections`: not NULL. `count`: uav_count * hotspot_count.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_detections(const struct jcas_sim *sim,
                                    uint8_t *detections,
                                    size_t count);

/// Writes the normalised throughput of each pair by the kernel's link budget: from a UAV (row)
/// toward another (column). It is 0 where the two are not neighbours.
///
/// `sim`, `throughputs`: not NULL. `count`: uav_count * uav_count.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_throughputs(const struct jcas_sim *sim,
                                     double *throughputs,
                                     size_t count);

/// Writes the visited cells, row (y) by row: 1 where any UAV has been, else 0.
///
/// `sim`, `visited`: not NULL. `count`: grid_width * grid_height.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_visited(const struct jcas_sim *sim,
                                 uint8_t *visited,
                                 size_t count);

/// Writes the search maps: 1 where a UAV knows a cell to be searched, else 0. There is one grid for
/// each UAV in turn, row (y) by row.
///
/// `sim`, `maps`: not NULL. `count`: uav_count * grid_width * grid_height, or 0 without search
/// maps.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_search_maps(const struct jcas_sim *sim,
                                     uint8_t *maps,
                                     size_t count);

/// Writes the false alarms of the last sensing: 1 where a UAV saw a hotspot in a cell that held
/// none, else 0. There is one grid for each UAV in turn, row (y) by row.
///
/// `sim`, `alarms`: not NULL. `count`: uav_count * grid_width * grid_height, or 0 without false
/// alarms.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_false_alarms(const struct jcas_sim *sim,
                                      uint8_t *alarms,
                                      size_t count);

/// Writes the false confirmations, row (y) by row: 1 where a quorum has confirmed a cell that held
/// no hotspot, else 0.
///
/// `sim`, `cells`: not NULL. `count`: grid_width * grid_height, or 0 without false alarms.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_false_confirmations(const struct jcas_sim *sim,
                                             uint8_t *cells,
                                             size_t count);

/// Writes the reports that each UAV knows: the level of each cell, or 0. There is one grid for each
/// UAV in turn, row (y) by row.
///
/// `sim`, `levels`: not NULL. `count`: uav_count * grid_width * grid_height, or 0 without reports.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_reports(const struct jcas_sim *sim,
                                 uint8_t *levels,
                                 size_t count);

/** @} */

/** @defgroup snapshot Snapshots
 *  @{ */

/// Saves a simulation as bytes that are portable across platforms.
///
/// `sim`, `snapshot`: not NULL. `size`: snapshot_size bytes.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_save(const struct jcas_sim *sim,
                          void *snapshot,
                          size_t size);

/// Loads a saved simulation of an equal configuration, which continues exactly as the saved one
/// would have. Anything else is JCAS_ERROR_CORRUPT or JCAS_ERROR_MODEL_MISMATCH and changes
/// nothing.
///
/// `sim`, `snapshot`: not NULL. `size`: in bytes, any.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_load(struct jcas_sim *sim,
                          const void *snapshot,
                          size_t size);

/// Copies the state of `from` to `to`, whose configuration must be equal. The two are then
/// independent.
///
/// `from`, `to`: not NULL; may be the same.
/// Threads: none changes `from`, only this one uses `to`.
/// Statuses: NULL, ALIGNMENT, HANDLE, MODEL_MISMATCH.
JCAS_API JCAS_NODISCARD jcas_status jcas_sim_fork(const struct jcas_sim *from, struct jcas_sim *to);

/// Writes the fingerprint of a state, which is equal for equal states on every platform (FNV-1a, 64
/// bits).
///
/// `sim`, `state_hash`: not NULL.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE.
JCAS_API jcas_status jcas_sim_hash(const struct jcas_sim *sim, uint64_t *state_hash);

/** @} */

/** @defgroup trace Traces
 *  @{ */

/// Writes the size and alignment of the memory that recording and verification need.
///
/// `model`, `size`, `alignment`: not NULL. `size` in bytes.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_trace_layout(const struct jcas_model *model,
                              size_t *size,
                              size_t *alignment);

/// Begins the episode of a seed, as jcas_sim_reset does, and records it. Every step, and every call
/// that replaces a part of the kernel's step or state, becomes a line of the trace. `jcas trace
/// verify` repeats such a file bit for bit, and `jcas replay` shows it.
///
/// Calls that replace the state end the recording without its last line, which readers report.
/// These are jcas_sim_reset, _load, _free, a fork into the simulation, jcas_batch_get and
/// jcas_trace_verify. If the sink refuses the first line, the call returns JCAS_ERROR_SINK and
/// changes nothing. If it refuses a later one, the simulation goes on and jcas_sim_record_end
/// returns JCAS_ERROR_SINK.
///
/// `sim`, `recorder`: not NULL; recorder->struct_size set; the struct itself is not needed after
/// the call.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, ARGUMENT, SINK.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_record(struct jcas_sim *sim,
                            uint64_t seed,
                            const struct jcas_recorder *recorder);

/// Ends a recording between steps and writes its last line. It returns JCAS_ERROR_OUT_OF_ORDER in
/// the middle of a step or without a recording. It returns JCAS_ERROR_SINK if the sink has refused
/// any part of the trace; the recording has then ended too.
///
/// `sim`: not NULL.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, OUT_OF_ORDER, SINK.
JCAS_API JCAS_NODISCARD jcas_status jcas_sim_record_end(struct jcas_sim *sim);

/// Fills `config` with the configuration of a trace.
///
/// `trace`: `length` bytes of a file of `jcas trace record` or of jcas_sim_record; not NULL.
/// `config`: not NULL. `struct_size`: sizeof(jcas_config). `message`: see the rules below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CORRUPT.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_trace_config(const char *trace,
                              size_t length,
                              struct jcas_config *config,
                              size_t struct_size,
                              char *message,
                              size_t message_capacity);

/// Repeats a trace and compares every line byte by byte. JCAS_OK means that this library reproduces
/// the file. JCAS_ERROR_DIFFERENT means that it does not; the message names the line and the field.
/// JCAS_ERROR_CORRUPT means that the file is cut, changed or no trace. The simulation is left where
/// the trace ends or differs.
///
/// `sim`: not NULL; of the trace's configuration (jcas_trace_config), or JCAS_ERROR_MODEL_MISMATCH.
/// `memory`: at least the size and alignment of jcas_trace_layout; not NULL; the caller's again
/// after the call. `trace`: `length` bytes, as jcas writes them; not NULL. `message`: see the rules
/// below.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, DIFFERENT.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_trace_verify(struct jcas_sim *sim,
                              void *memory,
                              size_t size,
                              const char *trace,
                              size_t length,
                              char *message,
                              size_t message_capacity);

/// Repeats a trace to the end of its next step, and compares these lines as jcas_trace_verify does.
///
/// `offset`: where the lines begin, in bytes; not NULL. Set it to 0 for the first call, which
/// checks the whole file, resets the simulation and compares the first line. Each call moves it to
/// the end of the next step; the last call moves it to `length`. Between calls the simulation may
/// be read. The other arguments are as for jcas_trace_verify.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, DIFFERENT.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_trace_step(struct jcas_sim *sim,
                            void *memory,
                            size_t size,
                            const char *trace,
                            size_t length,
                            size_t *offset,
                            char *message,
                            size_t message_capacity);

/** @} */

/** @defgroup batch Batches
 *  @{ */

/// Builds M environments in memory of their own, each at t = 0 of seed 0.
///
/// `model`: not NULL; must not be freed before the batch. `environments`: Number of environments
/// (M), at least 1. `threads`: threads that step at once, including the caller's; 1 starts none, 0
/// means one for each processor. Results do not depend on it. If the machine has enough processors,
/// workers spin for some tens of microseconds after a step before they sleep. `batch`: not NULL;
/// receives the handle, which jcas_batch_free ends.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_new(const struct jcas_model *model,
                           uint32_t environments,
                           uint32_t threads,
                           struct jcas_batch **batch);

/// Writes the size and alignment of the memory that jcas_batch_init needs.
///
/// `model`, `options`, `size`, `alignment`: not NULL; options->struct_size set. `size` in bytes.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE, ARGUMENT, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_layout(const struct jcas_model *model,
                              const struct jcas_batch_options *options,
                              size_t *size,
                              size_t *alignment);

/// Builds a batch in the caller's memory, which must not move until jcas_batch_free. Each
/// environment is at t = 0 of seed 0.
///
/// `memory`: at least the size and alignment of jcas_batch_layout; not NULL; the caller's. `model`:
/// not NULL; must not be freed before the batch. `options`: not NULL, struct_size set; not needed
/// after the call. `batch`: not NULL; receives the handle.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, ARGUMENT, IN_USE, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_init(void *memory,
                            size_t size,
                            const struct jcas_model *model,
                            const struct jcas_batch_options *options,
                            struct jcas_batch **batch);

/// Ends a batch and joins its threads. Memory of jcas_batch_init belongs to the caller again. NULL
/// is allowed and does nothing.
///
/// Threads: none may be using the batch.
/// Statuses: NULL, ALIGNMENT, HANDLE.
JCAS_API jcas_status jcas_batch_free(struct jcas_batch *batch);

/** @} */

/** @defgroup batch_step Steps of a batch
 *  @{ */

/// Begins an episode in each environment and writes the first observations.
///
/// `seeds`: M; not NULL. `observations`: M * uav_count * observation_len; not NULL. `global`: M *
/// global_len, or NULL with a count of 0. No buffer may overlap another.
/// Threads: only this one uses `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_reset(struct jcas_batch *batch,
                             const uint64_t *seeds,
                             size_t seed_count,
                             float *observations,
                             size_t observation_count,
                             float *global,
                             size_t global_count);

/// Begins an episode in each environment whose `mask` is not 0 and writes its observations. The
/// other environments, and their rows of the buffers, do not change.
///
/// `mask`: M; not NULL. The other arguments are as for jcas_batch_reset. Seeds of environments
/// whose mask is 0 are not used.
/// Threads: only this one uses `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_reset_some(struct jcas_batch *batch,
                                  const uint8_t *mask,
                                  size_t mask_count,
                                  const uint64_t *seeds,
                                  size_t seed_count,
                                  float *observations,
                                  size_t observation_count,
                                  float *global,
                                  size_t global_count);

/// Steps every environment once and writes rewards and observations.
///
/// With `auto_reset` = 1 the next episode follows at once; its seed is jcas_derive_seed(seed, 0).
/// With 0 the batch refuses the step while any environment's episode has ended. Everything is
/// checked before any environment steps, so an error changes nothing.
///
/// `actions`: M * action_len, one row as for jcas_sim_step for each environment; not NULL. `out`:
/// not NULL; see jcas_batch_out.
/// Threads: only this one uses `batch`. A batch with worker threads steps only in the process that
/// built it. After a fork the child gets JCAS_ERROR_FORKED; it may read and free the batch.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, ARGUMENT, NAN, OUT_OF_ORDER,
/// EPISODE_OVER, FORKED.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_step(struct jcas_batch *batch,
                            const float *actions,
                            size_t action_count,
                            int32_t auto_reset,
                            const struct jcas_batch_out *out);

/// Writes the present observations and global states of all environments.
///
/// `observations`: M * uav_count * observation_len; not NULL. `global`: M * global_len, or NULL
/// with a count of 0. No buffer may overlap another.
/// Threads: only this one uses `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_observe(struct jcas_batch *batch,
                               float *observations,
                               size_t observation_count,
                               float *global,
                               size_t global_count);

/// Saves every environment as M consecutive snapshots in the format of jcas_sim_save.
///
/// `batch`, `snapshots`: not NULL. `size`: M * snapshot_size bytes.
/// Threads: none changes `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_save(const struct jcas_batch *batch,
                            void *snapshots,
                            size_t size);

/// Loads the snapshots that jcas_batch_save wrote for a batch of equal size and configuration. If
/// any snapshot is invalid, it returns JCAS_ERROR_CORRUPT or JCAS_ERROR_MODEL_MISMATCH and changes
/// nothing.
///
/// `batch`, `snapshots`: not NULL. `size`: M * snapshot_size bytes.
/// Threads: only this one uses `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_load(struct jcas_batch *batch,
                            const void *snapshots,
                            size_t size);

/// Writes the fingerprint of all states of a batch in their order (FNV-1a, 64 bits).
///
/// `batch`, `states_hash`: not NULL.
/// Threads: none changes `batch`.
/// Statuses: NULL, ALIGNMENT, HANDLE.
JCAS_API jcas_status jcas_batch_hash(const struct jcas_batch *batch, uint64_t *states_hash);

/// Copies an environment of a batch into a simulation of an equal configuration. The simulation can
/// then read or save the state.
///
/// `batch`, `sim`: not NULL. `index`: below M, or JCAS_ERROR_ARGUMENT.
/// Threads: none changes `batch`, only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, MODEL_MISMATCH.
JCAS_API
jcas_status jcas_batch_get(const struct jcas_batch *batch,
                           uint32_t index,
                           struct jcas_sim *sim);

/// Copies a simulation of an equal configuration into an environment of a batch. The simulation
/// should be between steps: jcas_batch_step refuses a state in the middle of a step by parts.
///
/// `batch`, `sim`: not NULL. `index`: below M, or JCAS_ERROR_ARGUMENT.
/// Threads: only this one uses `batch`, none changes `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, MODEL_MISMATCH.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_set(struct jcas_batch *batch,
                           uint32_t index,
                           const struct jcas_sim *sim);

/// Writes why the last call that took this batch without const was refused. The text names the
/// value and what is allowed; it is empty if that call succeeded. UAVs are counted over the whole
/// batch.
///
/// `text`, `capacity`, `length`: as for jcas_config_to_json.
/// Threads: none changes `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_batch_message(const struct jcas_batch *batch,
                               char *text,
                               size_t capacity,
                               size_t *length);

/** @} */

/** @defgroup policy Policies
 *  @{ */

/// Writes the size and alignment of the memory that jcas_policy_init needs.
///
/// `model`, `file`, `size`, `alignment`: not NULL. `file`: the bytes of a policy.safetensors.
/// `size` in bytes. `message`: see the rules below. JCAS_ERROR_CORRUPT means that the bytes are no
/// policy. JCAS_ERROR_MODEL_MISMATCH means that the policy reads observations of another shape.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_layout(const struct jcas_model *model,
                               const uint8_t *file,
                               size_t length,
                               size_t *size,
                               size_t *alignment,
                               char *message,
                               size_t message_capacity);

/// Builds a trained policy in the caller's memory, which must not move until jcas_policy_free.
///
/// `memory`: at least the size and alignment of jcas_policy_layout; not NULL; the caller's.
/// `model`: not NULL; must not be freed before the policy. `file`: as for jcas_policy_layout; not
/// needed after the call. `policy`: not NULL; receives the handle. `message`: see the rules below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, IN_USE, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_init(void *memory,
                             size_t size,
                             const struct jcas_model *model,
                             const uint8_t *file,
                             size_t length,
                             struct jcas_policy **policy,
                             char *message,
                             size_t message_capacity);

/// Builds a trained policy in memory from the system. jcas_policy_free ends it.
///
/// It acts in the `mode` and with the `pilot_density` of its file. The mode is deterministic if the
/// file has none.
///
/// `model`: not NULL; must not be freed before the policy. `file`: the bytes of a
/// policy.safetensors; not needed after the call. `policy`: not NULL; receives the handle.
/// `message`: see the rules below. JCAS_ERROR_CORRUPT means that the bytes are no policy.
/// JCAS_ERROR_MODEL_MISMATCH means that the policy reads observations of another shape.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_load(const struct jcas_model *model,
                             const uint8_t *file,
                             size_t length,
                             struct jcas_policy **policy,
                             char *message,
                             size_t message_capacity);

/// Builds a baseline by its name. jcas_policy_free ends it. The names are random, untrained,
/// greedy, teams, squads, line and answer, as for `jcas simulate --policy`; jcas_policy_name lists
/// them. Plans are on the heap: jcas_policy_act allocates in the first step of an episode and in
/// each step that plans.
///
/// Two more names stand for policies that anneal plans, as jcas_plan_search and jcas_plan_tour do.
/// `plan` follows one plan without feedback. `replan` plans again after each
/// confirmation, meeting and report. If the model hides hotspots, this call makes the first plan,
/// which takes seconds; otherwise the first step of each episode does.
///
/// `model`: not NULL; must not be freed before the policy. `name`: not NULL. `pilot`: min, mid,
/// max, adaptive or a density such as 0.15; NULL means adaptive. A plan has its own densities.
/// `policy`: not NULL; receives the handle. `message`: see the rules below. JCAS_ERROR_ARGUMENT
/// means that the name is unknown, or that the baseline needs positions that the model hides. It
/// also means that the fleet, the grid or the mission is too large for a plan.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_baseline(const struct jcas_model *model,
                                 const char *name,
                                 const char *pilot,
                                 struct jcas_policy **policy,
                                 char *message,
                                 size_t message_capacity);

/// Returns the name of a policy for jcas_policy_baseline: a static string, or NULL for an index
/// beyond the last one. The baselines come first.
/// Threads: any.
JCAS_API const char *jcas_policy_name(uint32_t index);

/// Returns what the policy with this index does, in a few words: a static string, or NULL for an
/// index beyond the last one.
/// Threads: any.
JCAS_API const char *jcas_policy_summary(uint32_t index);

/// Sets how a trained policy derives actions from its network. Baselines are not affected.
///
/// `policy`: not NULL. `mode`: JCAS_POLICY_DETERMINISTIC or JCAS_POLICY_SAMPLED.
/// Threads: only this one uses `policy`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT.
JCAS_API JCAS_NODISCARD jcas_status jcas_policy_set_mode(struct jcas_policy *policy, int32_t mode);

/// Writes the actions of the policy for the present state of a simulation, as jcas_sim_step takes
/// them.
///
/// The bits are the same on every platform. `sim` may belong to another model with the same
/// configuration; it does not change. After RESOURCES, which means no memory for a plan, the same
/// call may be repeated.
///
/// teams, squads, line, answer and replan remember what they planned. They begin anew at t = 0, and
/// in the first state of all. From then on they act in every state of one simulation. Another
/// state is JCAS_ERROR_MEMORY. It is one of another simulation, one after a step without them, or
/// one that was loaded or forked. The function jcas_policy_memory_load brings the memory of such a
/// state back, and jcas_policy_forget begins anew in it.
///
/// `policy`, `sim`, `actions`: not NULL. `action_count`: action_len.
/// Threads: only this one uses `policy`, none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, NAN, MODEL_MISMATCH, MEMORY, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_act(struct jcas_policy *policy,
                            const struct jcas_sim *sim,
                            float *actions,
                            size_t action_count);

/// Writes the actions for every environment of a batch, as jcas_policy_act does for one simulation.
/// Environments are processed in order on this thread. After JCAS_ERROR_NAN (a network output is
/// not finite), the actions of the environments before are written.
///
/// `policy`, `batch`, `actions`: not NULL. `action_count`: count * action_len.
/// Threads: only this one uses `policy`, none changes `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, NAN, MODEL_MISMATCH, MEMORY, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_act_batch(struct jcas_policy *policy,
                                  const struct jcas_batch *batch,
                                  float *actions,
                                  size_t action_count);

/// Ends a policy. Memory of jcas_policy_init belongs to the caller again. NULL is allowed and does
/// nothing.
///
/// Threads: none may be using the policy.
/// Statuses: NULL, ALIGNMENT, HANDLE.
JCAS_API jcas_status jcas_policy_free(struct jcas_policy *policy);

/// Saves what a policy remembers of the simulation that it acts for, as bytes that are portable
/// across platforms. With the simulation's own snapshot they give the same future.
///
/// `policy`, `sim`, `length`: not NULL. `length` receives the number of bytes. `memory`: `capacity`
/// bytes, or NULL with a capacity of 0 to ask for the length. A capacity below the length is
/// JCAS_ERROR_LENGTH. JCAS_ERROR_MEMORY means that the policy remembers another state than the one
/// of `sim` or the one before it.
/// Threads: only this one uses `policy`, none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, MEMORY.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_memory_save(struct jcas_policy *policy,
                                    const struct jcas_sim *sim,
                                    void *memory,
                                    size_t capacity,
                                    size_t *length);

/// Loads what a policy remembered when it acted for a simulation, into this or an equal policy. The
/// policy then goes on for `sim` as it did for the simulation that was saved.
///
/// `policy`, `sim`: not NULL. `memory`: `size` bytes of jcas_policy_memory_save. JCAS_ERROR_MEMORY
/// means that they belong to another policy, or to another state than the one of `sim`. An error
/// changes nothing.
/// Threads: only this one uses `policy`, none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, MEMORY, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_memory_load(struct jcas_policy *policy,
                                    const struct jcas_sim *sim,
                                    const void *memory,
                                    size_t size);

/// Saves what a policy remembers of an environment of a batch, as jcas_policy_memory_save does of a
/// simulation. The bytes can be loaded for a simulation with the same state, and the other way
/// round.
///
/// `policy`, `batch`, `memory`, `length`: as for jcas_policy_memory_save. `index`: below M, or
/// JCAS_ERROR_ARGUMENT.
/// Threads: only this one uses `policy`, none changes `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, MODEL_MISMATCH, MEMORY.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_memory_save_member(struct jcas_policy *policy,
                                           const struct jcas_batch *batch,
                                           uint32_t index,
                                           void *memory,
                                           size_t capacity,
                                           size_t *length);

/// Loads what a policy remembered, for an environment of a batch, as jcas_policy_memory_load does
/// for a simulation.
///
/// `policy`, `batch`, `memory`: as for jcas_policy_memory_load. `index`: below M, or
/// JCAS_ERROR_ARGUMENT.
/// Threads: only this one uses `policy`, none changes `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, MODEL_MISMATCH, CORRUPT, MEMORY, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_memory_load_member(struct jcas_policy *policy,
                                           const struct jcas_batch *batch,
                                           uint32_t index,
                                           const void *memory,
                                           size_t size);

/// Makes a policy forget what it remembers of all simulations and environments. It begins anew in
/// the next state that it acts in, whichever that is.
///
/// `policy`: not NULL.
/// Threads: only this one uses `policy`.
/// Statuses: NULL, ALIGNMENT, HANDLE.
JCAS_API jcas_status jcas_policy_forget(struct jcas_policy *policy);

/// Plans an episode whose hotspots are hidden: any set of distinct cells without a depot is as
/// likely as any other. The annealing runs on this thread. jcas_plan_free ends the plan.
///
/// `model`, `settings`, `plan`: not NULL; settings->struct_size set. `plan` receives the handle.
/// `message`: see the rules below. JCAS_ERROR_ARGUMENT means that `reserved` is not 0,
/// or that the fleet, the grid, the number of hotspots or the horizon is too large.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE, ARGUMENT, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_plan_search(const struct jcas_model *model,
                             const struct jcas_plan_settings *settings,
                             struct jcas_plan **plan,
                             char *message,
                             size_t message_capacity);

/// Plans an episode whose hotspots lie in known cells. The plan decides which UAVs visit them, in
/// which order, how many together and for how long. The annealing runs on this thread.
/// jcas_plan_free ends the plan.
///
/// `model`, `hotspots`, `settings`, `plan`: not NULL; settings->struct_size set. `hotspots`: one
/// cell of the grid for each hotspot. `hotspot_count`: that of the model. `plan` receives the
/// handle. `message`: see the rules below. JCAS_ERROR_ARGUMENT means that a cell lies off the grid.
/// It also means what it means for jcas_plan_search.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, ARGUMENT, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_plan_tour(const struct jcas_model *model,
                           const struct jcas_cell *hotspots,
                           size_t hotspot_count,
                           const struct jcas_plan_settings *settings,
                           struct jcas_plan **plan,
                           char *message,
                           size_t message_capacity);

/// Reads a plan from the JSON text of jcas_plan_to_json or `jcas plan`. jcas_plan_free ends it.
///
/// `model`, `text`, `plan`: not NULL. `text`: `text_length` bytes of UTF-8, no terminating zero
/// needed. `plan` receives the handle. `message`: see the rules below. JCAS_ERROR_CORRUPT means
/// that the text is no plan of this fleet. JCAS_ERROR_MODEL_MISMATCH means that the plan was made
/// for another configuration.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_plan_from_json(const struct jcas_model *model,
                                const char *text,
                                size_t text_length,
                                struct jcas_plan **plan,
                                char *message,
                                size_t message_capacity);

/// Writes a plan as JSON text, as `jcas plan` does. It holds the configuration too.
///
/// `plan`: not NULL. `text`: `capacity` bytes, or NULL with a capacity of 0 to ask for the length.
/// `length`: not NULL; receives the length without the terminating zero. `capacity` must be at
/// least one more; otherwise the call writes only the length and returns JCAS_ERROR_LENGTH.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_plan_to_json(const struct jcas_plan *plan,
                              char *text,
                              size_t capacity,
                              size_t *length);

/// Writes the size of a plan and what it promises.
///
/// `plan`, `info`: not NULL; info->struct_size set.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_plan_get_info(const struct jcas_plan *plan,
                               struct jcas_plan_info *info);

/// Writes the cells of a plan: for each UAV its cell before the first step, then after each step.
///
/// `plan`, `cells`: not NULL. `count`: uav_count * (step_count + 1).
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_plan_get_cells(const struct jcas_plan *plan,
                                struct jcas_cell *cells,
                                size_t count);

/// Writes the pilot densities of a plan, for each UAV one for each step.
///
/// `plan`, `densities`: not NULL. `count`: uav_count * step_count.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_plan_get_pilot_densities(const struct jcas_plan *plan,
                                          double *densities,
                                          size_t count);

/// Builds the policy that follows a plan, which jcas_policy_act flies. The fleet follows the plan
/// without feedback; the plan makes it meet. jcas_policy_free ends the policy.
///
/// `model`, `plan`, `policy`: not NULL. `model` must not be freed before the policy; the plan is
/// copied. `policy` receives the handle.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, MODEL_MISMATCH, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_follow(const struct jcas_model *model,
                               const struct jcas_plan *plan,
                               struct jcas_policy **policy);

/// Ends a plan. NULL is allowed and does nothing.
///
/// Threads: none may be using the plan.
/// Statuses: ALIGNMENT, HANDLE.
JCAS_API jcas_status jcas_plan_free(struct jcas_plan *plan);

/** @} */

/** @defgroup futures Futures of a state
 *  @{ */

/// Copies the state of a simulation of an equal configuration into every environment of a batch,
/// where jcas_batch_rollout can continue it.
///
/// `batch`, `sim`: not NULL. `seeds`: M, or NULL with a count of 0. NULL keeps the seed, so that
/// equal actions give equal futures. Otherwise all later draws of environment m follow from
/// `seeds[m]`; what was drawn before stays, such as the hotspots. jcas_derive_seed gives seeds.
/// `policy`: NULL, or a policy of the same configuration; what it remembers of `sim` is copied for
/// every environment. JCAS_ERROR_MEMORY means that it remembers another state than the one of `sim`
/// or the one before it. After JCAS_ERROR_RESOURCES the states are copied, but not all memory is:
/// call jcas_policy_forget.
/// Threads: only this one uses `batch` and `policy`, none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, MEMORY, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_fork(struct jcas_batch *batch,
                            const struct jcas_sim *sim,
                            struct jcas_policy *policy,
                            const uint64_t *seeds,
                            size_t seed_count);

/// Steps every environment `steps` times, or until its episode ends. A policy chooses the actions,
/// or they are given. An environment whose episode has ended already makes no step.
///
/// The results are those of jcas_policy_act_batch and jcas_batch_step in turn, and do not depend on
/// the threads. Each thread takes one environment after the other through all its steps, and makes
/// no observation that no policy reads.
///
/// `batch`, `out`: not NULL; see jcas_rollout_out. `policy`: of the same configuration, or NULL if
/// the actions are given. `actions`: M * steps * action_len, environment by environment, then step
/// by step; or NULL with a count of 0 if there is a policy. `steps`: at least 1. Arguments are
/// checked before any environment steps, and so is what the policy remembers. If a network output
/// is not finite (JCAS_ERROR_NAN) or a policy finds no memory (JCAS_ERROR_RESOURCES), that
/// environment stays where it is. The others go on, and the outputs are written.
/// Threads: only this one uses `batch` and `policy`; see jcas_batch_step.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, ARGUMENT, NAN, MODEL_MISMATCH,
/// OUT_OF_ORDER, RESOURCES, FORKED, MEMORY.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_rollout(struct jcas_batch *batch,
                               struct jcas_policy *policy,
                               const float *actions,
                               size_t action_count,
                               uint32_t steps,
                               const struct jcas_rollout_out *out);

/** @} */

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* JCAS_H */

/* The rules of every function
 *
 * Statuses. Every function that can fail returns a jcas_status: JCAS_OK (0) or a negative
 *   JCAS_ERROR_... code. An error leaves every output, buffer and handle unchanged, with three
 *   exceptions. One is the length of a text that did not fit. Another is the actions of
 *   jcas_policy_act_batch if a network output is not finite. The third is jcas_batch_fork and
 *   jcas_batch_rollout with a policy, which say what an error leaves. `Statuses:` at a declaration
 *   lists the errors that it can return, without JCAS_ERROR_. INTERNAL is always possible, and so
 *   is BUSY if a jcas_sim, jcas_batch, jcas_policy or jcas_plan is passed.
 * Memory. ..._new takes memory from the system. ..._init builds in memory of the caller, whose size
 *   ..._layout returns. ..._free ends both kinds. Every other object must end before its model,
 *   except a jcas_plan, which has its own copy of all that it needs. The library keeps no pointer
 *   that is passed in, with three exceptions: the memory of ..._init, the model of an object, and
 *   the pointers in a jcas_recorder. Only ..._new, jcas_policy_load and jcas_policy_follow
 *   allocate, in one piece for each object. A program with its own allocator therefore uses
 *   ..._layout and ..._init. Baselines and jcas_plan_... plan on the heap (jcas_policy_baseline),
 *   and so does jcas_batch_rollout with any policy.
 *   Threads of a batch have stacks from the system. If the system refuses memory or threads, the
 *   status is RESOURCES; nothing aborts, with one exception. Annealing and reading a plan begin by
 *   asking the system for the most that they can take, and return RESOURCES if it is refused. If
 *   the rest of the program uses up this memory meanwhile, the program ends.
 * Pointers. A pointer must not be NULL unless the function says so. The library returns a status
 *   for a NULL or misaligned pointer and for a wrong number of elements. It does so too for a
 *   handle that is of the wrong kind, was freed, or was copied to another address. Beyond that the
 *   caller promises that the memory is valid and that outputs overlap nothing.
 * Structs that may grow begin with struct_size. Set it to the sizeof of the struct before the call,
 *   unless the function takes it as an argument. A struct grows at its end and with the minor
 *   version of the interface. The library accepts every size that the struct has had since the last
 *   major version. Today that is exactly its sizeof; any other size is STRUCT_SIZE.
 * Messages. `message`, where a function has one, receives the reason why a configuration, a policy,
 *   a plan or a trace was refused: a C string, cut to message_capacity bytes. It is untouched
 *   otherwise, and may be NULL. A legal configuration may still be unsolvable: with a quorum above
 *   N no hotspot is ever confirmed.
 * Threads. Any number of threads may use a const jcas_model or jcas_plan at once. One thread at a
 *   time may use a jcas_sim, jcas_batch or jcas_policy; functions that take it as const may run at
 *   once with each other. Any other concurrent call returns BUSY and does nothing. That holds for
 *   other threads, for calls from within a jcas_run_tasks or jcas_write of a call on the same
 *   object, and for ..._free. BUSY cannot guard memory: once ..._free has returned OK, no call may
 *   use the object. ..._message does not describe a call that was BUSY. The library has no global
 *   state; the threads of a batch end with it. A batch with threads steps only in the process that
 *   built it: after a fork the child gets FORKED and builds another one.
 * Numbers. N UAVs, n hotspots, a grid of W by H cells, M environments of a batch. Counts are of
 *   elements, sizes are of bytes, flags are 0 or 1. Equal inputs give equal bits on every platform.
 */
