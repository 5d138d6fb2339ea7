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
 * Four kinds of object, each behind an opaque handle:
 *   jcas_model   a validated configuration and its tables; it never changes.
 *   jcas_sim     one state of a model: one running episode.
 *   jcas_batch   many states of a model, stepped together.
 *   jcas_policy  a controller of a fleet: a trained network or a baseline.
 *
 * Order of calls:  reset -> step -> step -> ... -> (terminated or truncated) -> reset
 * A step by parts: step_begin -> [set_positions, ground, confirm_hotspot] -> step_sense[_with]
 *                  -> step_communicate[_with] -> step_end
 * Between steps: set_battery, move_hotspot; at t = 0 also set_starts, set_hotspots, set_batteries.
 * A trace: record in place of reset, ..., record_end.
 *
 * The rules that hold for every function stand at the end of this file: statuses, memory, pointers, structs,
 * messages, threads, numbers. docs/c.md is a tutorial.
 */

#ifndef JCAS_H
#define JCAS_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

/* Stands before everything that the library exports. Define JCAS_SHARED where a Windows program uses the
 * shared library. */
#ifndef JCAS_API
#if defined(_WIN32) && defined(JCAS_SHARED)
#define JCAS_API __declspec(dllimport)
#else
#define JCAS_API
#endif
#endif

/* The compiler warns where a status is not read. Define it empty to turn the warning off. */
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

/// Version of the library that this header belongs to.
#define JCAS_VERSION_MAJOR 0

/// See JCAS_VERSION_MAJOR.
#define JCAS_VERSION_MINOR 1

/// See JCAS_VERSION_MAJOR.
#define JCAS_VERSION_PATCH 0

/// Version of the interface that this header declares: 16777216 * major + 65536 * minor, counted apart
/// from the library's, as most releases do not change it. 1.0 is the first that was released. Headers
/// from before have numbers of major version 0, which no release serves.
#define JCAS_ABI_VERSION 16777216

/** @} */

/** @defgroup status Statuses
 *  @{ */

/// The call did what it says.
#define JCAS_OK 0

/// A pointer that must not be NULL is NULL.
#define JCAS_ERROR_NULL (-1)

/// A pointer is not aligned for its type.
#define JCAS_ERROR_ALIGNMENT (-2)

/// A buffer, or memory for a handle, has the wrong size.
#define JCAS_ERROR_LENGTH (-3)

/// A `struct_size` is none that this library knows.
#define JCAS_ERROR_STRUCT_SIZE (-4)

/// A handle is none of this kind, was closed, or was moved.
#define JCAS_ERROR_HANDLE (-5)

/// A configuration field is outside its range, or a text is no configuration.
#define JCAS_ERROR_CONFIG (-6)

/// An argument is outside its range.
#define JCAS_ERROR_ARGUMENT (-7)

/// An action component is NaN, or a network gives no finite number.
#define JCAS_ERROR_NAN (-8)

/// A state and a model, or two states, have different configurations.
#define JCAS_ERROR_MODEL_MISMATCH (-9)

/// A part of a step was called out of its order.
#define JCAS_ERROR_OUT_OF_ORDER (-10)

/// The episode has ended: reset before the next step.
#define JCAS_ERROR_EPISODE_OVER (-11)

/// The bytes are not a snapshot of this model, not a policy, or not a trace.
#define JCAS_ERROR_CORRUPT (-12)

/// The model still has simulations or batches, or memory given to ..._init holds a living handle.
#define JCAS_ERROR_IN_USE (-13)

/// Memory or threads could not be had from the system.
#define JCAS_ERROR_RESOURCES (-14)

/// The program was compiled for an incompatible version of this library.
#define JCAS_ERROR_ABI (-15)

/// A fault of the library itself; please report it. The handle of the call should be reset or freed.
#define JCAS_ERROR_INTERNAL (-16)

/// The batch has threads, which a forked process does not have: build another one there.
#define JCAS_ERROR_FORKED (-17)

/// The caller's sink has not taken all of a trace.
#define JCAS_ERROR_SINK (-18)

/// A trace, flown again, is not what its file says.
#define JCAS_ERROR_DIFFERENT (-19)

/// Another call is using the object, on another thread or around this one: one thread at a time may use it.
#define JCAS_ERROR_BUSY (-20)

/** @} */

/** @defgroup values Values of fields and arguments
 *  @{ */

/// Most depots of a configuration.
#define JCAS_MAX_DEPOTS 16

/// Every hotspot's position is seen, as in the paper.
#define JCAS_VISIBILITY_KNOWN 0

/// Only positions of hotspots that the UAV knows are seen: a search.
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

/// Each UAV keeps a map of the cells that it knows to have been looked at; maps spread with knowledge.
#define JCAS_MAPS_SHARED 1

/// Observations do not tell how much is unsearched in each direction.
#define JCAS_DIRECTIONS_OFF 0

/// Observations tell how much is unsearched in each of eight directions.
#define JCAS_DIRECTIONS_SHOWN 1

/// Nothing tells UAVs in one cell apart.
#define JCAS_TAG_OFF 0

/// Observations end with the UAV's index over N - 1.
#define JCAS_TAG_INDEX 1

/// A step may begin, whole or by parts: jcas_sim_step, jcas_sim_step_begin.
#define JCAS_PHASE_READY 1

/// The UAVs have acted and moved: jcas_sim_set_positions, jcas_sim_step_sense.
#define JCAS_PHASE_MOVED 2

/// The UAVs have sensed and learnt: jcas_sim_step_communicate, jcas_sim_step_communicate_with.
#define JCAS_PHASE_SENSED 3

/// Knowledge has spread: jcas_sim_step_end.
#define JCAS_PHASE_COMMUNICATED 4

/// The episode has ended, every hotspot is informed: jcas_sim_reset.
#define JCAS_PHASE_TERMINATED 5

/// The horizon has ended the episode: jcas_sim_reset.
#define JCAS_PHASE_TRUNCATED 6

/// Fields of an observation; jcas_observation_field_name names them.
#define JCAS_OBSERVATION_FIELDS 21

/// Motion up, +y, as the first component of an action.
#define JCAS_MOVE_UP (-0.8f)

/// Motion down, -y.
#define JCAS_MOVE_DOWN (-0.4f)

/// Motion left, -x.
#define JCAS_MOVE_LEFT 0.0f

/// Motion right, +x.
#define JCAS_MOVE_RIGHT 0.4f

/// No motion.
#define JCAS_MOVE_STAY 0.8f

/// The most likely motion and the mean pilot density.
#define JCAS_POLICY_DETERMINISTIC 0

/// Draws from the network's distribution, which follow from the mission's seed, the step and the
/// UAV.
#define JCAS_POLICY_SAMPLED 1

/// Motions shared out, which draws nothing: UAVs of one cell take quantiles that lie apart.
/// The mean pilot density.
#define JCAS_POLICY_STRATIFIED 2

/** @} */

/** @defgroup handles Handles
 *  @{ */

/// M environments of one model, with their working memory and, if wanted, threads of their own. One
/// thread at a time may use it.
typedef struct jcas_batch jcas_batch;

/// A validated configuration with everything that can be worked out before the first step. It never
/// changes: any number of threads may use one model at once.
typedef struct jcas_model jcas_model;

/// What flies a fleet: a trained network or a baseline, for missions of one model. One thread at a
/// time may use it; several policies may fly on one model at once.
typedef struct jcas_policy jcas_policy;

/// One state of a model, with its working memory. One thread at a time may use it; functions that take
/// it as const may run at once with each other.
typedef struct jcas_sim jcas_sim;

/// What a call came to: JCAS_OK or a negative JCAS_ERROR_...
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

/// Every decision of the model. Fill it by jcas_config_default (or one of the other functions that do),
/// then change fields. Beside each field: [unit, legal range; default]. Symbols are those of the paper.
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
    /// Positive detections in one step that confirm a hotspot (θ); above N none ever is. [UAVs, 1 to 4096;
    /// default 3]
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
    /// Single-pulse probability of false alarm that defines the threshold. [probability, 1e-7 to
    /// 1e-3; default 1e-6]
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
    /// A battery below this at the start of a step sends the UAV to the nearest depot; 0 turns it
    /// off. [kWh, 0 to 100; default 0.04]
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
    /// Whether each UAV keeps a map of the cells that it knows to have been looked at: JCAS_MAPS_OFF
    /// (default) or JCAS_MAPS_SHARED.
    int32_t search_maps;
    /// A UAV has looked at the cells whose centre is at most this far from its own. [m, 0 to 1e6;
    /// default 100]
    double search_map_radius_m;
    /// Observations show the map this many cells around the UAV; 0: not at all. [cells, 0 to 32; default 0]
    uint32_t map_window_radius;
    /// Whether observations show how much is unsearched in eight directions: JCAS_DIRECTIONS_OFF
    /// (default) or JCAS_DIRECTIONS_SHOWN.
    int32_t map_directions;
    /// What tells UAVs in one cell apart: JCAS_TAG_OFF (default) or JCAS_TAG_INDEX.
    int32_t uav_tag;
    /// Weight of each unconfirmed hotspot in the potential of w_g, in longest ways over the grid (w_u);
    /// from 1 on a confirmation never lowers it. [longest ways, 0 to 1000; default 1]
    double shaping_unconfirmed_weight;
    /// The threshold (γ_det) is the sensing SNR at this distance, before the load's penalty; an explicit
    /// detection_threshold_db wins; JCAS_DERIVED: by Albersheim's equation. [m, 0.001 to 1e6; default
    /// JCAS_DERIVED]
    double sensing_range_m;
} jcas_config;

/// Sizes and constants of a model; buffers are sized by these.
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
    /// Floats of one UAV's observation: 11 + 4 n + 3 neighbour_slots, and what map_window_radius,
    /// map_directions and uav_tag add.
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

/// Entries of one UAV's observation that mean the same: at offset, offset + stride and on, `count` of them.
typedef struct jcas_observation_field {
    /// The first entry.
    uint32_t offset;
    /// One, one for each hotspot, neighbour slot, cell or direction, or 0 where the configuration leaves
    /// the field out.
    uint32_t count;
    /// From one entry to the next.
    uint32_t stride;
} jcas_observation_field;

/// Radar and link between two cells.
typedef struct jcas_radio {
    /// sizeof(jcas_radio); set it before the call.
    uint32_t struct_size;
    /// Always 0.
    uint32_t reserved;
    /// Sensing SNR before the communication load is taken off, in dB.
    double sensing_snr_db;
    /// Probability that a UAV detects a hotspot in one step.
    double detection_probability;
    /// Communication SNR, in dB.
    double comm_snr_db;
    /// Normalised throughput of a UAV toward another.
    double link_throughput;
} jcas_radio;

/// What a step came to.
typedef struct jcas_outcome {
    /// sizeof(jcas_outcome); set it before the call.
    uint32_t struct_size;
    /// 1 if every hotspot is informed, else 0.
    uint32_t terminated;
    /// 1 if the horizon ended the episode before that, else 0.
    uint32_t truncated;
    /// Always 0.
    uint32_t reserved;
    /// The team reward, the same for every UAV.
    double reward;
} jcas_outcome;

/// The scalars of a state.
typedef struct jcas_episode {
    /// sizeof(jcas_episode); set it before the call.
    uint32_t struct_size;
    /// Steps begun since the reset.
    uint32_t t;
    /// What may be called next: JCAS_PHASE_READY and so on.
    uint32_t phase;
    /// 1 if every hotspot is informed, else 0.
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

/// What an episode came to, so far or at its end.
typedef struct jcas_metrics {
    /// sizeof(jcas_metrics); set it before the call.
    uint32_t struct_size;
    /// Steps taken.
    uint32_t steps;
    /// 1 if every hotspot is informed (the mission succeeded), else 0.
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
    /// Energy asked for that was not there, in kWh.
    double shortfall_kwh;
    /// Grid energy billed, in kWh.
    double grid_kwh;
    /// Carbon emitted, in kg.
    double co2_kg;
    /// Mean over the steps of the fleet's mean normalised throughput.
    double throughput_mean;
    /// Mean over steps and UAVs of the pilot density, a fraction.
    double pilot_density_mean;
} jcas_metrics;

/// A UAV.
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
    /// Energy asked for that was not there, in microjoules.
    uint64_t shortfall_uj;
    /// Pilot density, a fraction.
    double pilot_density;
    /// Mean normalised throughput toward its neighbours; 0 without any.
    double throughput;
    /// What jcas_sim_set_battery has put into the battery, less what it has taken out, in microjoules.
    int64_t given_uj;
} jcas_uav;

/// A hotspot.
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

/// Takes `count` bytes of a trace, in their order; `context` is the caller's own. Returns 0; anything else
/// says that they could not be taken, and no more are offered.
typedef int32_t (*jcas_write)(const char *bytes, size_t count, void *context);

/// Where a recording goes, and what it works in. Everything that is pointed to, but for the names, stays
/// the caller's and must live until the recording ends.
typedef struct jcas_recorder {
    /// sizeof(jcas_recorder).
    uint32_t struct_size;
    /// Set it to 0.
    uint32_t reserved;
    /// Takes the trace; not NULL.
    jcas_write write;
    /// Passed to `write`.
    void *write_context;
    /// Who flies, UTF-8, for the reader; NULL means "host".
    const char *policy;
    /// How the pilot density is chosen, for the reader; NULL means "host".
    const char *pilot;
    /// At least the size and alignment of jcas_trace_layout; not NULL.
    void *memory;
    /// Its size in bytes.
    size_t memory_size;
} jcas_recorder;

/// One task of a batch step. Run it with the context that came with it and a number below `count`.
typedef void (*jcas_task)(void *task_context, uint32_t index);

/// The caller's way to run tasks: calls `task(task_context, index)` once for each index from 0 to count - 1,
/// in any order and on any threads, and returns when all of these calls have. `context` is the caller's own.
/// Tasks that it leaves out the step runs itself; where it has run none, the step is JCAS_ERROR_ARGUMENT.
typedef void (*jcas_run_tasks)(jcas_task task, void *task_context, uint32_t count, void *context);

/// How a batch is built.
typedef struct jcas_batch_options {
    /// sizeof(jcas_batch_options).
    uint32_t struct_size;
    /// M, at least 1.
    uint32_t environments;
    /// How many threads step at once, the caller's among them. 1: no other is started. 0: one for each
    /// processor. With `run`: how many tasks a step has; no thread is started.
    uint32_t threads;
    /// Set it to 0.
    uint32_t reserved;
    /// The caller's way to run the tasks of a step, or NULL.
    jcas_run_tasks run;
    /// Passed to `run`.
    void *run_context;
} jcas_batch_options;

/// Buffers that a batch step writes, for M environments; each pointer with its number of elements.
/// Optional ones may be NULL with a count of 0. No buffer may overlap another, or the actions.
typedef struct jcas_batch_out {
    /// sizeof(jcas_batch_out).
    uint32_t struct_size;
    /// Set it to 0.
    uint32_t reserved;
    /// M * uav_count * observation_len: what each UAV observes, after an automatic reset the new
    /// episode's first.
    float *observations;
    /// Elements of observations.
    size_t observation_count;
    /// M: the team reward.
    float *rewards;
    /// Elements of rewards.
    size_t reward_count;
    /// M: 1 where the step ended the episode because every hotspot is informed, else 0.
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
    /// M * uav_count * observation_len: where an episode was reset, its last observation; untouched
    /// elsewhere; optional.
    float *final_observations;
    /// Elements of final_observations.
    size_t final_observation_count;
    /// M * global_len: where an episode was reset, its last global state; untouched elsewhere; optional.
    float *final_global;
    /// Elements of final_global.
    size_t final_global_count;
    /// M: where an episode ended, what it came to; untouched elsewhere; optional.
    struct jcas_metrics *final_metrics;
    /// Elements of final_metrics.
    size_t final_metrics_count;
    /// sizeof(jcas_metrics), or 0 without final_metrics.
    size_t metrics_size;
    /// M * uav_count: the reward of each UAV, whose mean over a fleet is the team's; optional.
    float *uav_rewards;
    /// Elements of uav_rewards.
    size_t uav_reward_count;
} jcas_batch_out;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/** @} */

/** @defgroup version Versions and words of a status
 *  @{ */

/// Version of the library that runs, such as "0.1.0". A static string, never NULL. Threads: any.
JCAS_API const char *jcas_version(void);

/// Version of the interface of the library that runs. Threads: any.
JCAS_API uint32_t jcas_abi_version(void);

/// Whether the library that runs serves a program compiled with this header:
/// `jcas_abi_check(JCAS_ABI_VERSION)`. It does if the header has its major version and no later minor
/// one. Ask before any other call, which cannot tell another version from a wrong size. Threads: any.
/// Statuses: ABI.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_abi_check(uint32_t header_abi_version);

/// What a status means, in English.
///
/// Returns a static string, never NULL; also for values that are no status.
/// Threads: any.
JCAS_API const char *jcas_status_string(jcas_status status);

/** @} */

/** @defgroup config Configurations
 *  @{ */

/// Fills `config` with the default, the preset "mission". Pass sizeof(jcas_config) as `struct_size`.
///
/// `config`: not NULL. Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE.
JCAS_API
jcas_status jcas_config_default(struct jcas_config *config,
                                size_t struct_size);

/// Fills `config` with a preset: "mission", "paper" (the letter of every equation of the paper) or "search"
/// (hidden hotspots, shared search maps).
///
/// `name`: `name_length` bytes, not NULL, no terminating zero needed. `message`: see the rules below.
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

/// Fills `config` from a TOML text. It may name a `preset` (else "mission"); every other key is a field
/// and replaces the preset's value; unknown keys are errors. The result is validated.
///
/// `text`: `text_length` bytes of UTF-8, not NULL, no terminating zero needed. `message`: see the rules
/// below. Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_config_from_toml(const char *text,
                                  size_t text_length,
                                  struct jcas_config *config,
                                  size_t struct_size,
                                  char *message,
                                  size_t message_capacity);

/// As jcas_config_from_toml, from a JSON object; null takes a field that may be derived back to that.
///
/// `text`, `message`: as for jcas_config_from_toml. Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_config_from_json(const char *text,
                                  size_t text_length,
                                  struct jcas_config *config,
                                  size_t struct_size,
                                  char *message,
                                  size_t message_capacity);

/// Whether a configuration is legal: JCAS_OK or JCAS_ERROR_CONFIG, with a message that names the field,
/// its value and what is allowed.
///
/// `config`: not NULL, struct_size set. `message`: see the rules below. Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, CONFIG.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_config_validate(const struct jcas_config *config,
                                 char *message,
                                 size_t message_capacity);

/// The fingerprint of a legal configuration; part of every state and snapshot.
///
/// `config`, `hash`: not NULL, struct_size set. Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, CONFIG.
JCAS_API jcas_status jcas_config_hash(const struct jcas_config *config, uint64_t *hash);

/// A legal configuration as JSON text, which jcas_config_from_json reads back; derived fields are absent.
///
/// `text`: `capacity` bytes, or NULL with a capacity of 0 to ask for the length. `length`: not NULL;
/// receives the length without the terminating zero, so that `capacity` must be at least one more;
/// also where the text does not fit, with JCAS_ERROR_LENGTH.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_config_to_json(const struct jcas_config *config,
                                char *text,
                                size_t capacity,
                                size_t *length);

/// As jcas_config_to_json, as TOML text, which jcas_config_from_toml reads back.
///
/// `text`, `capacity`, `length`: as for jcas_config_to_json. Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_config_to_toml(const struct jcas_config *config,
                                char *text,
                                size_t capacity,
                                size_t *length);

/// The fields of the configuration as JSON text: a list of objects with name, unit, low, high,
/// default (null: derived) and doc.
///
/// `text`, `capacity`, `length`: as for jcas_config_to_json. Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH.
JCAS_API JCAS_NODISCARD jcas_status jcas_config_fields(char *text, size_t capacity, size_t *length);

/** @} */

/** @defgroup model Models
 *  @{ */

/// How much memory a model takes, for jcas_model_init.
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

/// Builds a model in the caller's memory, which holds it until jcas_model_free and may not be moved.
///
/// `memory`: at least the size and alignment of jcas_model_layout; not NULL; the caller's.
/// `config`: not NULL; not needed after the call. `model`: not NULL; receives the handle.
/// `message`: see the rules below. Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG, IN_USE, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_model_init(void *memory,
                            size_t size,
                            const struct jcas_config *config,
                            struct jcas_model **model,
                            char *message,
                            size_t message_capacity);

/// Builds a model in memory of its own, to be ended by jcas_model_free.
///
/// `config`: not NULL; not needed after the call. `model`: not NULL; receives the handle.
/// `message`: see the rules below. Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, CONFIG, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_model_new(const struct jcas_config *config,
                           struct jcas_model **model,
                           char *message,
                           size_t message_capacity);

/// Ends a model; memory of the caller is the caller's again. NULL is allowed and does nothing.
/// JCAS_ERROR_IN_USE while simulations or batches of the model have not been freed.
///
/// Threads: none may be using the model.
/// Statuses: NULL, ALIGNMENT, HANDLE, IN_USE.
JCAS_API jcas_status jcas_model_free(struct jcas_model *model);

/// Sizes and constants of a model.
///
/// `model`, `info`: not NULL; info->struct_size set. Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE.
JCAS_API
jcas_status jcas_model_get_info(const struct jcas_model *model,
                                struct jcas_model_info *info);

/// Where each field of one UAV's observation lies. Together the fields name every entry once.
///
/// `model`, `fields`: not NULL. `count`: JCAS_OBSERVATION_FIELDS. `struct_size`:
/// sizeof(jcas_observation_field). Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_model_observation_fields(const struct jcas_model *model,
                                          struct jcas_observation_field *fields,
                                          size_t count,
                                          size_t struct_size);

/// The name of a field of an observation, such as "soc" or "hotspot_dx": a static string, or NULL from
/// JCAS_OBSERVATION_FIELDS on. Threads: any.
JCAS_API
const char *jcas_observation_field_name(uint32_t index);

/// The configuration of a model.
///
/// `model`, `config`: not NULL. `struct_size`: sizeof(jcas_config). Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE.
JCAS_API
jcas_status jcas_model_get_config(const struct jcas_model *model,
                                  struct jcas_config *config,
                                  size_t struct_size);

/// Radar and link over an offset of (dx, dy) cells, at a pilot density of the sender.
///
/// `model`, `radio`: not NULL; radio->struct_size set. `dx` below W, `dy` below H, `pilot_density` from
/// 0 to 1, or JCAS_ERROR_ARGUMENT. Threads: any.
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

/// How much memory a simulation takes, for jcas_sim_init.
///
/// `model`, `size`, `alignment`: not NULL. `size` in bytes. Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_layout(const struct jcas_model *model,
                            size_t *size,
                            size_t *alignment);

/// Builds a simulation in the caller's memory, which holds it until jcas_sim_free and may not be moved.
/// It is at t = 0 of seed 0.
///
/// `memory`: at least the size and alignment of jcas_sim_layout; not NULL; the caller's.
/// `model`: not NULL; must not be freed before the simulation. `sim`: not NULL; receives the handle.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, IN_USE, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_init(void *memory,
                          size_t size,
                          const struct jcas_model *model,
                          struct jcas_sim **sim);

/// Builds a simulation in memory of its own, to be ended by jcas_sim_free. It is at t = 0 of seed 0.
///
/// `model`: not NULL; must not be freed before the simulation. `sim`: not NULL; receives the handle.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_new(const struct jcas_model *model,
                         struct jcas_sim **sim);

/// Ends a simulation; memory of the caller is the caller's again. NULL is allowed and does nothing.
///
/// Threads: none may be using the simulation.
/// Statuses: NULL, ALIGNMENT, HANDLE.
JCAS_API jcas_status jcas_sim_free(struct jcas_sim *sim);

/// Begins the episode of a seed; everything random in it follows from the seed.
///
/// `sim`: not NULL. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE.
JCAS_API JCAS_NODISCARD jcas_status jcas_sim_reset(struct jcas_sim *sim, uint64_t seed);

/// The seed with the given index that follows from a seed: mission k of a campaign of the command line
/// has the seed jcas_derive_seed(seed, k), and an automatic reset goes on with index 0.
///
/// Threads: any.
JCAS_API
uint64_t jcas_derive_seed(uint64_t seed,
                          uint64_t index);

/// One whole step.
///
/// `actions`: a pair per UAV, action_len floats; not NULL. The first of a pair chooses the motion
/// (JCAS_MOVE_UP and so on; five equal bins of -1 to 1), the second the pilot density, from its minimum
/// at -1 to its maximum at 1. Both are clipped; NaN is refused. `outcome`: not NULL, struct_size set.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, NAN, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_step(struct jcas_sim *sim,
                          const float *actions,
                          size_t action_count,
                          struct jcas_outcome *outcome);

/// Writes what each UAV observes: uav_count rows of observation_len floats.
///
/// Each row: itself (x/(W-1), y/(H-1), state of charge, pilot density from minimum 0 to maximum 1, mean
/// throughput); each hotspot (dx/(W-1), dy/(H-1), confirmed, known); each neighbour slot, nearest first
/// (present, dx/(W-1), dy/(H-1)); neighbours/(N-1); carbon intensity from 0 to 1; depot
/// distance/(W+H-2); confirmed/n; informed/n; t/T_max.
///
/// `sim`, `observations`: not NULL. `count`: uav_count * observation_len. Threads: only this one uses
/// `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_observe(struct jcas_sim *sim,
                             float *observations,
                             size_t count);

/// Writes the global state, for a centralised critic: global_len floats.
///
/// Each UAV (x/(W-1), y/(H-1), state of charge, pilot density, mean throughput, fraction of hotspots
/// known); each hotspot (x/(W-1), y/(H-1), confirmed, fraction of UAVs that know it); carbon intensity,
/// confirmed/n, informed/n, t/T_max.
///
/// `sim`, `global`: not NULL. Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_observe_global(const struct jcas_sim *sim,
                                    float *global,
                                    size_t count);

/// Why the last call that took this simulation without const was refused, in words: which value, and what
/// is allowed. Empty if that call did what it says.
///
/// `text`, `capacity`, `length`: as for jcas_config_to_json. Threads: none changes `sim`.
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
/// `sim`, `actions`: as for jcas_sim_step. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, NAN, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_step_begin(struct jcas_sim *sim,
                                const float *actions,
                                size_t action_count);

/// Puts the UAVs where the host has moved them, in place of the kernel's own motion. A UAV whose cell
/// differs from the one before the step has moved, however far.
///
/// `sim`, `cells`: not NULL. `count`: uav_count. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_set_positions(struct jcas_sim *sim,
                                   const struct jcas_cell *cells,
                                   size_t count);

/// Part 2 of a step: sense and learn. Next: jcas_sim_step_communicate or jcas_sim_step_communicate_with.
///
/// `sim`: not NULL. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_step_sense(struct jcas_sim *sim);

/// Keeps a UAV from flying, sensing and communicating in this step, whatever its battery holds. It stays
/// where it was before the step and asks its battery for nothing. Between jcas_sim_step_begin and
/// jcas_sim_step_sense, after jcas_sim_set_positions if that is called too.
///
/// `sim`: not NULL. `uav`: below uav_count, or JCAS_ERROR_ARGUMENT. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_ground(struct jcas_sim *sim,
                            uint32_t uav);

/// Confirms a hotspot in this step, whatever was detected. Between jcas_sim_step_begin and
/// jcas_sim_step_sense: UAVs that then detect it learn it. Nothing changes if it is confirmed already.
///
/// `sim`: not NULL. `hotspot`: below hotspot_count, or JCAS_ERROR_ARGUMENT. Threads: only this one uses
/// `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_confirm_hotspot(struct jcas_sim *sim,
                                     uint32_t hotspot);

/// Part 2 of a step with the host's detections, in place of jcas_sim_step_sense.
///
/// `sim`, `detections`: not NULL. `count`: uav_count * hotspot_count, a row for each UAV; any value but 0 is
/// a detection. Those of grounded UAVs and of hotspots that the UAV knows are ignored, as no draw is made
/// there. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_step_sense_with(struct jcas_sim *sim,
                                     const uint8_t *detections,
                                     size_t count);

/// Part 3 of a step: communicate over the graph that the kernel's link budget gives. Next:
/// jcas_sim_step_end.
///
/// `sim`: not NULL. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API JCAS_NODISCARD jcas_status jcas_sim_step_communicate(struct jcas_sim *sim);

/// Part 3 of a step over the host's graph, in place of jcas_sim_step_communicate.
///
/// `links`: a uav_count * uav_count matrix, row by row, any value but 0 is a link; not NULL. It must be
/// symmetric; the diagonal and links of grounded UAVs are ignored. `throughput`: the mean normalised
/// throughput of each UAV toward its neighbours as the host measured it, uav_count numbers from 0 to 1e9;
/// or NULL with a count of 0 to take it from the kernel's link budget. A UAV without neighbours has 0 in
/// either case. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_step_communicate_with(struct jcas_sim *sim,
                                           const uint8_t *links,
                                           size_t link_count,
                                           const double *throughput,
                                           size_t throughput_count);

/// Part 4 of a step: energy, charge, carbon, reward, termination.
///
/// `sim`, `outcome`: not NULL, struct_size set. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_step_end(struct jcas_sim *sim,
                              struct jcas_outcome *outcome);

/// Places the hotspots, in place of the drawn ones: distinct cells without a depot. At t = 0 only.
///
/// `sim`, `cells`: not NULL. `count`: hotspot_count. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_set_hotspots(struct jcas_sim *sim,
                                  const struct jcas_cell *cells,
                                  size_t count);

/// Moves a hotspot. Between steps; whether it is confirmed and who knows it stays.
///
/// `sim`: not NULL. `hotspot`: below hotspot_count. `x`, `y`: a cell of the grid without a depot or another
/// hotspot. JCAS_ERROR_ARGUMENT for anything else. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_move_hotspot(struct jcas_sim *sim,
                                  uint32_t hotspot,
                                  uint32_t x,
                                  uint32_t y);

/// Puts the UAVs where they start, in place of the first depot. At t = 0 only.
///
/// `sim`, `cells`: not NULL. `count`: uav_count. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_set_starts(struct jcas_sim *sim,
                                const struct jcas_cell *cells,
                                size_t count);

/// Sets what a battery holds now, in microjoules. Between steps; 0 grounds the UAV from the next step on.
/// The difference enters the ledger as given_uj of jcas_uav.
///
/// `sim`: not NULL. `uav`: below uav_count, `charge_uj`: at most battery_capacity_uj, or
/// JCAS_ERROR_ARGUMENT. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_set_battery(struct jcas_sim *sim,
                                 uint32_t uav,
                                 uint64_t charge_uj);

/// Sets what each battery holds at the start, in microjoules, in place of the drawn charge. At t = 0 only.
///
/// `sim`, `charges_uj`: not NULL. `count`: uav_count. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_set_batteries(struct jcas_sim *sim,
                                   const uint64_t *charges_uj,
                                   size_t count);

/** @} */

/** @defgroup queries Queries of a simulation
 *  @{ */

/// Time, phase and the fleet's ledgers.
///
/// `sim`, `episode`: not NULL; episode->struct_size set. Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE.
JCAS_API jcas_status jcas_sim_get_episode(const struct jcas_sim *sim, struct jcas_episode *episode);

/// What the episode came to, so far.
///
/// `sim`, `metrics`: not NULL; metrics->struct_size set. Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE.
JCAS_API jcas_status jcas_sim_get_metrics(const struct jcas_sim *sim, struct jcas_metrics *metrics);

/// The components of the last reward. The reward is their sum, from the first to the last.
///
/// `sim`, `components`: not NULL. `count`: reward_len. Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_rewards(const struct jcas_sim *sim,
                                 double *components,
                                 size_t count);

/// The reward of each UAV in the last step, 0 before the first. Their mean is the team's: detections,
/// informing, completion, truncation and the spread of knowledge are shared; coverage, energy, carbon and
/// revisits are the UAV's own, times N; so are, in place of their means, its throughput and its potentials.
///
/// `sim`, `rewards`: not NULL. `count`: uav_count. Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_uav_rewards(const struct jcas_sim *sim,
                                 double *rewards,
                                 size_t count);

/// The components of jcas_sim_uav_rewards: a row of reward_len for each UAV, named by jcas_reward_name, whose
/// sum, left to right, is the UAV's reward.
///
/// `sim`, `components`: not NULL. `count`: uav_count * reward_len. Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_uav_reward_components(const struct jcas_sim *sim,
                                           double *components,
                                           size_t count);

/// The name of a component of the reward: a static string, or NULL from reward_len on. Threads: any.
JCAS_API
const char *jcas_reward_name(uint32_t index);

/// Every UAV.
///
/// `sim`, `uavs`: not NULL. `count`: uav_count. `struct_size`: sizeof(jcas_uav). Threads: none changes
/// `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE.
JCAS_API
jcas_status jcas_sim_get_uavs(const struct jcas_sim *sim,
                              struct jcas_uav *uavs,
                              size_t count,
                              size_t struct_size);

/// Every hotspot.
///
/// `sim`, `hotspots`: not NULL. `count`: hotspot_count. `struct_size`: sizeof(jcas_hotspot). Threads:
/// none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE.
JCAS_API
jcas_status jcas_sim_get_hotspots(const struct jcas_sim *sim,
                                  struct jcas_hotspot *hotspots,
                                  size_t count,
                                  size_t struct_size);

/// The radio graph: 1 where two UAVs are neighbours, else 0; a symmetric matrix, row by row.
///
/// `sim`, `links`: not NULL. `count`: uav_count * uav_count. Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API jcas_status jcas_sim_get_links(const struct jcas_sim *sim, uint8_t *links, size_t count);

/// Who knows what: 1 where a UAV (row) knows a hotspot (column), else 0.
///
/// `sim`, `knowledge`: not NULL. `count`: uav_count * hotspot_count. Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_knowledge(const struct jcas_sim *sim,
                                   uint8_t *knowledge,
                                   size_t count);

/// Who detected what when the UAVs last sensed: 1 where a UAV (row) detected a hotspot (column), else 0.
/// Hotspots that a UAV knew are not sensed by it.
///
/// `sim`, `detections`: not NULL. `count`: uav_count * hotspot_count. Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_detections(const struct jcas_sim *sim,
                                    uint8_t *detections,
                                    size_t count);

/// Normalised throughput of each pair by the kernel's link budget: from a UAV (row) toward another (column),
/// 0 where they are no neighbours.
///
/// `sim`, `throughputs`: not NULL. `count`: uav_count * uav_count. Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_throughputs(const struct jcas_sim *sim,
                                     double *throughputs,
                                     size_t count);

/// The cells that any UAV has been in: 1 or 0, row (y) by row.
///
/// `sim`, `visited`: not NULL. `count`: grid_width * grid_height. Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_visited(const struct jcas_sim *sim,
                                 uint8_t *visited,
                                 size_t count);

/// The search maps: 1 where a UAV knows a cell to have been looked at, else 0; a grid, row (y) by row, for
/// each UAV after the other. Without search maps there is nothing to read.
///
/// `sim`, `maps`: not NULL. `count`: uav_count * grid_width * grid_height, or 0 without search maps.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_sim_get_search_maps(const struct jcas_sim *sim,
                                     uint8_t *maps,
                                     size_t count);

/** @} */

/** @defgroup snapshot Snapshots
 *  @{ */

/// Saves a simulation as bytes that mean the same on every platform.
///
/// `sim`, `snapshot`: not NULL. `size`: snapshot_size bytes. Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_save(const struct jcas_sim *sim,
                          void *snapshot,
                          size_t size);

/// Takes up a saved simulation of an equal configuration; it goes on exactly as the saved one would have.
/// JCAS_ERROR_CORRUPT or JCAS_ERROR_MODEL_MISMATCH for anything else, and nothing has changed then.
///
/// `sim`, `snapshot`: not NULL. `size`: in bytes, any. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_load(struct jcas_sim *sim,
                          const void *snapshot,
                          size_t size);

/// Makes `to` an independent twin of `from`, whose configuration must be equal.
///
/// `from`, `to`: not NULL; may be the same. Threads: none changes `from`, only this one uses `to`.
/// Statuses: NULL, ALIGNMENT, HANDLE, MODEL_MISMATCH.
JCAS_API JCAS_NODISCARD jcas_status jcas_sim_fork(const struct jcas_sim *from, struct jcas_sim *to);

/// The fingerprint of a state: equal for equal states, on every platform (FNV-1a, 64 bits).
///
/// `sim`, `state_hash`: not NULL. Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE.
JCAS_API jcas_status jcas_sim_hash(const struct jcas_sim *sim, uint64_t *state_hash);

/** @} */

/** @defgroup trace Traces
 *  @{ */

/// How much memory recording and verifying take.
///
/// `model`, `size`, `alignment`: not NULL. `size` in bytes. Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_trace_layout(const struct jcas_model *model,
                              size_t *size,
                              size_t *alignment);

/// Begins the episode of a seed, as jcas_sim_reset does, and records it: from here on every step, and
/// every call by which the host owns something, goes to the recorder as a line of the trace. `jcas trace
/// verify` flies such a file again bit for bit, `jcas replay` shows it.
///
/// Whatever puts another state into the simulation (jcas_sim_reset, _load, _free, a fork into it,
/// jcas_batch_get, jcas_trace_verify) leaves the recording as it is, without its end, which readers say.
/// If the sink refuses the first line, nothing has changed: JCAS_ERROR_SINK. If it refuses a later one,
/// the simulation goes on, and jcas_sim_record_end says so.
///
/// `sim`, `recorder`: not NULL; recorder->struct_size set; not needed after the call, but for what it
/// points to. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, ARGUMENT, SINK.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_record(struct jcas_sim *sim,
                            uint64_t seed,
                            const struct jcas_recorder *recorder);

/// Ends a recording, between steps: the last line goes to the recorder. JCAS_ERROR_OUT_OF_ORDER in the
/// middle of a step, or where nothing is recorded. JCAS_ERROR_SINK if the sink has not taken all of the
/// trace; the recording has ended then too.
///
/// `sim`: not NULL. Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, OUT_OF_ORDER, SINK.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_sim_record_end(struct jcas_sim *sim);

/// Fills `config` with the configuration that a trace was flown with.
///
/// `trace`: `length` bytes of a file of `jcas trace record` or of jcas_sim_record; not NULL. `config`: not
/// NULL. `struct_size`: sizeof(jcas_config). `message`: see the rules below. Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CORRUPT.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_trace_config(const char *trace,
                              size_t length,
                              struct jcas_config *config,
                              size_t struct_size,
                              char *message,
                              size_t message_capacity);

/// Flies a trace again and compares every line, byte by byte. JCAS_OK: this library does what the file
/// says. JCAS_ERROR_DIFFERENT: it does not; the message names the line and the field. JCAS_ERROR_CORRUPT:
/// the file was cut, changed, or is none. The simulation is left where the trace ends, or where it
/// differs.
///
/// `sim`: not NULL; of the trace's configuration (jcas_trace_config), or JCAS_ERROR_MODEL_MISMATCH.
/// `memory`: at least the size and alignment of jcas_trace_layout; not NULL; the caller's again after the
/// call. `trace`: `length` bytes, as jcas writes them; not NULL. `message`: see the rules below. Threads:
/// only this one uses `sim`.
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

/// Flies a trace again to the end of its next step, and compares these lines as jcas_trace_verify does.
///
/// `offset`: where the lines begin, in bytes; not NULL. Set it to 0 to begin: that checks the whole file,
/// resets the simulation and compares the first line. Each call then moves it to the end of the next step,
/// the last one to `length`. Between calls the simulation may be read. The others as for jcas_trace_verify.
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
/// `model`: not NULL; must not be freed before the batch. `environments`: M, at least 1. `threads`: how
/// many step at once; 1: the caller's own, no other is started; 0: one for each processor. Results do not
/// depend on it. Where there are as many processors, the others look for the next step for up to some
/// tens of microseconds before they sleep. `batch`: not NULL; receives the handle, to be ended by
/// jcas_batch_free.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_new(const struct jcas_model *model,
                           uint32_t environments,
                           uint32_t threads,
                           struct jcas_batch **batch);

/// How much memory a batch takes, for jcas_batch_init.
///
/// `model`, `options`, `size`, `alignment`: not NULL; options->struct_size set. `size` in bytes. Threads:
/// any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE, ARGUMENT, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_layout(const struct jcas_model *model,
                              const struct jcas_batch_options *options,
                              size_t *size,
                              size_t *alignment);

/// Builds a batch in the caller's memory, which holds it until jcas_batch_free and may not be moved. Each
/// environment is at t = 0 of seed 0.
///
/// `memory`: at least the size and alignment of jcas_batch_layout; not NULL; the caller's. `model`: not
/// NULL; must not be freed before the batch. `options`: not NULL, struct_size set; not needed after the
/// call. `batch`: not NULL; receives the handle. Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, ARGUMENT, IN_USE, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_init(void *memory,
                            size_t size,
                            const struct jcas_model *model,
                            const struct jcas_batch_options *options,
                            struct jcas_batch **batch);

/// Ends a batch and its threads, which have ended when the call returns; memory of the caller is the
/// caller's again. NULL is allowed and does nothing.
///
/// Threads: none may be using the batch.
/// Statuses: NULL, ALIGNMENT, HANDLE.
JCAS_API
jcas_status jcas_batch_free(struct jcas_batch *batch);

/** @} */

/** @defgroup batch_step Steps of a batch
 *  @{ */

/// Begins an episode in each environment and observes.
///
/// `seeds`: M; not NULL. `observations`: M * uav_count * observation_len; not NULL. `global`: M *
/// global_len, or NULL with a count of 0. No buffer may overlap another. Threads: only this one uses
/// `batch`.
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

/// Begins an episode in some environments, those where `mask` is not 0, and observes these. The others,
/// and their rows of the buffers, stay as they are.
///
/// `mask`: M; not NULL. The others as for jcas_batch_reset; seeds of the others are not used. Threads: only
/// this one uses `batch`.
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

/// Steps every environment once and observes.
///
/// With `auto_reset` = 1 an episode that ends is followed at once by the next, whose seed derives from
/// the ended one's. With 0 an environment whose episode has ended refuses the step, and so the batch does.
/// All is checked before any environment steps, so nothing has changed after an error.
///
/// `actions`: M times those of jcas_sim_step; not NULL. `out`: not NULL; see jcas_batch_out. Threads: only
/// this one uses `batch`. A batch with threads of its own steps only in the process that built it; after a
/// fork the child gets JCAS_ERROR_FORKED, may read and free the batch, and builds one of its own.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, ARGUMENT, NAN, OUT_OF_ORDER, EPISODE_OVER,
/// FORKED.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_step(struct jcas_batch *batch,
                            const float *actions,
                            size_t action_count,
                            int32_t auto_reset,
                            const struct jcas_batch_out *out);

/// Writes what the environments observe now.
///
/// `observations`: M * uav_count * observation_len; not NULL. `global`: M * global_len, or NULL with a
/// count of 0. No buffer may overlap another. Threads: only this one uses `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_observe(struct jcas_batch *batch,
                               float *observations,
                               size_t observation_count,
                               float *global,
                               size_t global_count);

/// Saves every environment: M snapshots, one after the other, each as jcas_sim_save writes it.
///
/// `batch`, `snapshots`: not NULL. `size`: M * snapshot_size bytes. Threads: none changes `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_save(const struct jcas_batch *batch,
                            void *snapshots,
                            size_t size);

/// Takes up what jcas_batch_save saved, of a batch of equal size and configuration. JCAS_ERROR_CORRUPT or
/// JCAS_ERROR_MODEL_MISMATCH if any snapshot is not right, and nothing has changed then.
///
/// `batch`, `snapshots`: not NULL. `size`: M * snapshot_size bytes. Threads: only this one uses `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_load(struct jcas_batch *batch,
                            const void *snapshots,
                            size_t size);

/// The fingerprint of all states of a batch, in their order (FNV-1a, 64 bits).
///
/// `batch`, `states_hash`: not NULL. Threads: none changes `batch`.
/// Statuses: NULL, ALIGNMENT, HANDLE.
JCAS_API jcas_status jcas_batch_hash(const struct jcas_batch *batch, uint64_t *states_hash);

/// Copies an environment of a batch into a simulation of an equal configuration, to read every quantity
/// or to save it.
///
/// `batch`, `sim`: not NULL. `index`: below M, or JCAS_ERROR_ARGUMENT. Threads: none changes `batch`,
/// only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, MODEL_MISMATCH.
JCAS_API
jcas_status jcas_batch_get(const struct jcas_batch *batch,
                           uint32_t index,
                           struct jcas_sim *sim);

/// Copies a simulation of an equal configuration into an environment of a batch. It should be between
/// steps: one in the middle of a step by parts makes jcas_batch_step refuse.
///
/// `batch`, `sim`: not NULL. `index`: below M, or JCAS_ERROR_ARGUMENT. Threads: only this one uses
/// `batch`, none changes `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, MODEL_MISMATCH.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_batch_set(struct jcas_batch *batch,
                           uint32_t index,
                           const struct jcas_sim *sim);

/// Why the last call that took this batch without const was refused, in words: which value, and what is
/// allowed. Empty if that call did what it says. UAVs are counted over the whole batch.
///
/// `text`, `capacity`, `length`: as for jcas_config_to_json. Threads: none changes `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
JCAS_API
jcas_status jcas_batch_message(const struct jcas_batch *batch,
                               char *text,
                               size_t capacity,
                               size_t *length);

/** @} */

/** @defgroup policy Policies
 *  @{ */

/// How much memory a trained policy takes, for jcas_policy_init.
///
/// `model`, `file`, `size`, `alignment`: not NULL. `file`: the bytes of a policy.safetensors.
/// `size` in bytes. `message`: see the rules below. JCAS_ERROR_CORRUPT where the bytes are no
/// policy, JCAS_ERROR_MODEL_MISMATCH where it reads other observations. Threads: any.
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

/// Builds a trained policy in the caller's memory, which holds it until jcas_policy_free and may
/// not be moved.
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

/// Builds a trained policy in memory of its own, to be ended by jcas_policy_free.
///
/// It flies as its file says (`mode`, `pilot_density`), deterministically where the file says
/// nothing.
///
/// `model`: not NULL; must not be freed before the policy. `file`: the bytes of a
/// policy.safetensors; not needed after the call. `policy`: not NULL; receives the handle.
/// `message`: see the rules below. JCAS_ERROR_CORRUPT where the bytes are no policy,
/// JCAS_ERROR_MODEL_MISMATCH where it reads other observations than the model has. Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_load(const struct jcas_model *model,
                             const uint8_t *file,
                             size_t length,
                             struct jcas_policy **policy,
                             char *message,
                             size_t message_capacity);

/// Builds a baseline by its name, to be ended by jcas_policy_free: random, greedy, swarm, teams,
/// sweep, line, frontier, relay, charging or clean, as `jcas simulate --policy` knows them. It
/// plans on the heap: jcas_policy_act asks for memory in the first step of an episode and whenever
/// it plans.
///
/// `model`: not NULL; must not be freed before the policy. `name`: not NULL. `pilot`: min, mid,
/// max, adaptive or a density such as 0.15; NULL means adaptive. `policy`: not NULL; receives the
/// handle. `message`: see the rules below. JCAS_ERROR_ARGUMENT where there is none of that name,
/// or where it steers by positions that the model hides. Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_baseline(const struct jcas_model *model,
                                 const char *name,
                                 const char *pilot,
                                 struct jcas_policy **policy,
                                 char *message,
                                 size_t message_capacity);

/// Chooses how a trained policy's actions follow from its network. Baselines are not affected.
///
/// `policy`: not NULL. `mode`: JCAS_POLICY_DETERMINISTIC, JCAS_POLICY_SAMPLED or
/// JCAS_POLICY_STRATIFIED.
/// Threads: only this one uses `policy`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT.
JCAS_API JCAS_NODISCARD jcas_status jcas_policy_set_mode(struct jcas_policy *policy, int32_t mode);

/// Writes the actions that the policy takes in a simulation's present state, for jcas_sim_step.
///
/// The same bits on every platform. `sim` may be of another model with the same configuration; it
/// is not changed. A baseline that plans over several steps begins anew at t = 0 and with another
/// seed. Where it finds no memory for its plan (RESOURCES), the same call may be made again.
///
/// `policy`, `sim`, `actions`: not NULL. `action_count`: action_len. Threads: only this one uses
/// `policy`, none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, NAN, MODEL_MISMATCH, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_act(struct jcas_policy *policy,
                            const struct jcas_sim *sim,
                            float *actions,
                            size_t action_count);

/// As jcas_policy_act for every simulation of a batch, one after the other on this thread. Where
/// the outputs of a network are no finite numbers (JCAS_ERROR_NAN), the actions before that
/// simulation are written.
///
/// `policy`, `batch`, `actions`: not NULL. `action_count`: count * action_len. Threads: only this
/// one uses `policy`, none changes `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, NAN, MODEL_MISMATCH, RESOURCES.
JCAS_API
JCAS_NODISCARD
jcas_status jcas_policy_act_batch(struct jcas_policy *policy,
                                  const struct jcas_batch *batch,
                                  float *actions,
                                  size_t action_count);

/// Ends a policy; memory of the caller is the caller's again. NULL is allowed and does nothing.
///
/// Threads: none may be using the policy.
/// Statuses: NULL, ALIGNMENT, HANDLE.
JCAS_API jcas_status jcas_policy_free(struct jcas_policy *policy);

/** @} */

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* JCAS_H */

/* The rules of every function
 *
 * Statuses. Every function that can fail returns a jcas_status: JCAS_OK (0) or a negative JCAS_ERROR_...
 *   After an error every output, buffer and handle is as it was, with two exceptions: the length of a text
 *   that did not fit, and the actions of jcas_policy_act_batch where a network gives no finite number.
 *   `Statuses:` at a declaration lists what it can return, without JCAS_ERROR_. INTERNAL is always possible,
 *   and BUSY where a jcas_sim, jcas_batch or jcas_policy is passed.
 * Memory. ..._new takes memory from the system. ..._init builds in memory of the caller, whose size
 *   ..._layout gives. Both end with ..._free; every other object ends before its model. Pointers that are
 *   passed in are not kept, with three exceptions: the memory of ..._init, the model of an object, and what a
 *   jcas_recorder points to.
 *   Only ..._new and jcas_policy_load allocate, in one piece for each object. So a program with an allocator
 *   of its own gives it to everything by ..._layout and ..._init. Baselines plan on the heap
 *   (jcas_policy_baseline). Threads of a batch have stacks from the system.
 *   Where memory or threads cannot be had, the status is RESOURCES; nothing aborts.
 * Pointers. Not NULL unless the function says so. A pointer that is NULL or misaligned gives a status. So do
 *   a handle of the wrong kind, closed or copied elsewhere, and a wrong number of elements. Beyond that the
 *   caller promises that the memory is there, and that outputs overlap nothing.
 * Structs that may grow begin with struct_size. Set it to the sizeof of the struct before the call, unless
 *   the function takes it as an argument. A struct grows at its end and with the minor version of the
 *   interface. The library accepts every size that the struct has had since the last major version. Today
 *   that is exactly its sizeof; any other size is STRUCT_SIZE.
 * Messages. `message`, where a function has one, receives the reason why a configuration, a policy or a trace
 *   was refused: a C string, cut to message_capacity bytes. It is untouched otherwise, and may be NULL.
 *   A legal configuration may still be hopeless: with a quorum above N nothing is ever confirmed.
 * Threads. Any number of threads may use a const jcas_model at once. One thread at a time may use a jcas_sim,
 *   jcas_batch or jcas_policy; functions that take it as const may run at once with each other. A call that
 *   finds the object in use otherwise returns BUSY and has done nothing. That holds for other threads, for
 *   calls from within a jcas_run_tasks or jcas_write of a call on the same object, and for ..._free.
 *   BUSY cannot guard memory: once ..._free has returned OK, no call may use the object or be about to.
 *   As others may have called since, ..._message says nothing about a call that was BUSY.
 *   The library has no global state; a batch's threads are its own and end with it. A batch with threads
 *   steps only in the process that built it: after a fork the child gets FORKED and builds its own.
 * Numbers. N UAVs, n hotspots, a grid of W by H cells, M environments of a batch. Counts are of elements,
 *   sizes are of bytes, flags are 0 or 1. Equal inputs give equal bits on every platform.
 */
