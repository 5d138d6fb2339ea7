//! The C structs in which models and simulations report their quantities.

use jcas_core::header::Phase;
use jcas_core::observation::fields;
use jcas_core::{Metrics, Model, StateRef, StepOutcome};

use crate::memory::{Plain, Record};

/// A step may begin, whole or by parts. Next: jcas_sim_step or jcas_sim_step_begin.
pub const JCAS_PHASE_READY: u32 = 1;
/// The UAVs have acted and moved. Next: jcas_sim_set_positions or jcas_sim_step_sense.
pub const JCAS_PHASE_MOVED: u32 = 2;
/// The UAVs have sensed. Next: jcas_sim_step_communicate or jcas_sim_step_communicate_with.
pub const JCAS_PHASE_SENSED: u32 = 3;
/// The UAVs have communicated. Next: jcas_sim_step_end.
pub const JCAS_PHASE_COMMUNICATED: u32 = 4;
/// The episode has ended with every hotspot informed. Next: jcas_sim_reset.
pub const JCAS_PHASE_TERMINATED: u32 = 5;
/// The horizon has ended the episode. Next: jcas_sim_reset.
pub const JCAS_PHASE_TRUNCATED: u32 = 6;

const _: () = assert!(JCAS_PHASE_READY == Phase::Ready as u32);
const _: () = assert!(JCAS_PHASE_TRUNCATED == Phase::Truncated as u32);

/// Declares the structs whose first field is their size.
macro_rules! records {
    ($($name:ident),+) => { $(
        // SAFETY: the struct has only integers and floats.
        unsafe impl Plain for $name {}
        // SAFETY: `struct_size` comes first.
        unsafe impl Record for $name {}
    )+ };
}
records!(
    jcas_model_info,
    jcas_radio,
    jcas_outcome,
    jcas_episode,
    jcas_metrics
);

// SAFETY: the struct has only integers and floats.
unsafe impl Plain for jcas_uav {}
// SAFETY: the struct has only integers and floats.
unsafe impl Plain for jcas_hotspot {}
// SAFETY: integers only.
unsafe impl Plain for jcas_observation_field {}

/// The number of fields of an observation, which jcas_observation_field_name names.
pub const JCAS_OBSERVATION_FIELDS: usize = 25;

const _: () = assert!(JCAS_OBSERVATION_FIELDS == fields::FIELDS);

/// The sizes and constants of a model, which determine the lengths of all buffers.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct jcas_model_info {
    /// sizeof(jcas_model_info); set it before the call.
    pub struct_size: u32,
    /// UAVs (N).
    pub uav_count: u32,
    /// Hotspots (n).
    pub hotspot_count: u32,
    /// Neighbours in an observation.
    pub neighbour_slots: u32,
    /// Cells of the grid along x (W).
    pub grid_width: u32,
    /// Cells of the grid along y (H).
    pub grid_height: u32,
    /// Floats of the actions of a step: 2 N.
    pub action_len: u32,
    /// Floats of one UAV's observation: 11 + 4 n + 3 neighbour_slots, plus the entries of
    /// map_window_radius, map_directions, uav_tag and report_slots.
    pub observation_len: u32,
    /// Floats of the global state: 6 N + 4 n + 4.
    pub global_len: u32,
    /// Components of a reward: 12.
    pub reward_len: u32,
    /// Bytes of a snapshot.
    pub snapshot_size: u64,
    /// Fingerprint of the configuration.
    pub config_hash: u64,
    /// Capacity of a battery, in microjoules.
    pub battery_capacity_uj: u64,
    /// Detection threshold, in dB.
    pub detection_threshold_db: f64,
}

/// A field of one UAV's observation: `count` entries at offset, offset + stride, offset + 2 stride
/// and so on.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct jcas_observation_field {
    /// Index of the first entry.
    pub offset: u32,
    /// Number of entries: one, or one for each hotspot, slot, cell or direction. It is 0
    /// if the configuration leaves the field out.
    pub count: u32,
    /// Distance from one entry to the next, in floats.
    pub stride: u32,
}

/// The radar and link budget between two cells.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct jcas_radio {
    /// sizeof(jcas_radio); set it before the call.
    pub struct_size: u32,
    /// Always 0.
    pub reserved: u32,
    /// Sensing SNR without the penalty of the communication load, in dB.
    pub sensing_snr_db: f64,
    /// Probability that a UAV detects a hotspot in one step.
    pub detection_probability: f64,
    /// Communication SNR, in dB.
    pub comm_snr_db: f64,
    /// Normalised throughput of a UAV toward another.
    pub link_throughput: f64,
}

/// The outcome of a step.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct jcas_outcome {
    /// sizeof(jcas_outcome); set it before the call.
    pub struct_size: u32,
    /// 1 if every hotspot is confirmed and informed, else 0.
    pub terminated: u32,
    /// 1 if the horizon ended the episode before that, else 0.
    pub truncated: u32,
    /// Cells without a hotspot that a quorum confirmed in this step.
    pub false_confirmations: u32,
    /// The team reward, the same for every UAV.
    pub reward: f64,
}

/// The scalars of a state.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct jcas_episode {
    /// sizeof(jcas_episode); set it before the call.
    pub struct_size: u32,
    /// Steps begun since the reset.
    pub t: u32,
    /// The phase of the step, which decides what may be called next: JCAS_PHASE_READY and so on.
    pub phase: u32,
    /// 1 if every hotspot is confirmed and informed, else 0.
    pub terminated: u32,
    /// 1 if the horizon ended the episode before that, else 0.
    pub truncated: u32,
    /// Hotspots confirmed.
    pub confirmed: u32,
    /// Hotspots that all UAVs know.
    pub informed: u32,
    /// Always 0.
    pub reserved: u32,
    /// Seed of the episode.
    pub seed: u64,
    /// Carbon intensity that the coming step will be billed with, in mg/kWh.
    pub carbon_intensity_mg_per_kwh: u64,
    /// Carbon intensity that the last step was billed with, in mg/kWh; 0 before the first.
    pub billed_intensity_mg_per_kwh: u64,
    /// Carbon emitted in the episode, in nanograms.
    pub co2_ng: u64,
    /// Grid energy billed in the episode, in microjoules.
    pub grid_uj: u64,
    /// Mean normalised throughput of the present graph, over all UAVs.
    pub mean_throughput: f64,
}

/// The state of a UAV.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct jcas_uav {
    /// Column of its cell.
    pub x: u32,
    /// Row of its cell.
    pub y: u32,
    /// 1 if it changed its cell in the last step, else 0.
    pub moved: u32,
    /// 1 if its battery was empty at the start of the last step, else 0.
    pub grounded: u32,
    /// 1 if a low battery sent it toward a depot in the last step, else 0.
    pub returning: u32,
    /// Neighbours in the radio graph.
    pub neighbours: u32,
    /// Hotspots that it knows.
    pub known: u32,
    /// Always 0.
    pub reserved: u32,
    /// Charge, in microjoules: initial + accepted + given - spent.
    pub battery_uj: u64,
    /// Charge at the start of the episode, in microjoules.
    pub initial_uj: u64,
    /// Energy accepted from chargers, in microjoules.
    pub accepted_uj: u64,
    /// Energy spent, in microjoules.
    pub spent_uj: u64,
    /// Energy demanded beyond the charge of the battery, in microjoules.
    pub shortfall_uj: u64,
    /// Pilot density, a fraction.
    pub pilot_density: f64,
    /// Mean normalised throughput toward its neighbours; 0 without any.
    pub throughput: f64,
    /// Net energy that jcas_sim_set_battery has added to the battery, in microjoules; negative if
    /// removed.
    pub given_uj: i64,
}

/// The state of a hotspot.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct jcas_hotspot {
    /// Column of its cell.
    pub x: u32,
    /// Row of its cell.
    pub y: u32,
    /// 1 if it is confirmed, else 0.
    pub confirmed: u32,
    /// 1 if all UAVs know it, else 0.
    pub informed: u32,
    /// Step at which it was confirmed; 0 before.
    pub confirmed_at: u32,
    /// Step at which all UAVs know it; 0 before.
    pub informed_at: u32,
}

/// The metrics of an episode, so far or at its end.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct jcas_metrics {
    /// sizeof(jcas_metrics); set it before the call.
    pub struct_size: u32,
    /// Steps taken.
    pub steps: u32,
    /// 1 if every hotspot is confirmed and informed (the mission succeeded), else 0.
    pub terminated: u32,
    /// 1 if the horizon ended the episode before that, else 0.
    pub truncated: u32,
    /// Hotspots confirmed.
    pub confirmed: u32,
    /// Hotspots that all UAVs know.
    pub informed: u32,
    /// Moves between cells, over all UAVs.
    pub moves: u64,
    /// Undiscounted return.
    pub return_sum: f64,
    /// Energy spent by the fleet, in kWh.
    pub energy_kwh: f64,
    /// Energy accepted from chargers, in kWh.
    pub accepted_kwh: f64,
    /// Energy demanded beyond the charge of the batteries, in kWh.
    pub shortfall_kwh: f64,
    /// Grid energy billed, in kWh.
    pub grid_kwh: f64,
    /// Carbon emitted, in kg.
    pub co2_kg: f64,
    /// Mean over the steps of the fleet's mean normalised throughput.
    pub throughput_mean: f64,
    /// Mean over steps and UAVs of the pilot density, a fraction.
    pub pilot_density_mean: f64,
    /// Cells without a hotspot that a quorum confirmed.
    pub false_confirmations: u64,
}

impl jcas_model_info {
    pub(crate) fn of(model: &Model<'_>) -> Self {
        let config = model.config();
        Self {
            struct_size: Self::SIZE,
            uav_count: config.uav_count,
            hotspot_count: config.hotspot_count,
            neighbour_slots: model.neighbour_slots() as u32,
            grid_width: config.grid_width,
            grid_height: config.grid_height,
            action_len: model.action_len() as u32,
            observation_len: model.observation_len() as u32,
            global_len: model.global_len() as u32,
            reward_len: jcas_core::reward::COMPONENTS as u32,
            snapshot_size: model.save_len() as u64,
            config_hash: model.config_hash(),
            battery_capacity_uj: model.energy().capacity_uj,
            detection_threshold_db: model.detection_threshold_db(),
        }
    }
}

impl jcas_outcome {
    pub(crate) fn of(outcome: StepOutcome) -> Self {
        Self {
            struct_size: Self::SIZE,
            terminated: outcome.terminated.into(),
            truncated: outcome.truncated.into(),
            false_confirmations: outcome.false_confirmations,
            reward: outcome.reward,
        }
    }
}

impl jcas_episode {
    pub(crate) fn of(state: &StateRef<'_>) -> Self {
        Self {
            struct_size: Self::SIZE,
            t: state.t(),
            phase: state.header.phase().map_or(0, |phase| phase as u32),
            terminated: state.terminated().into(),
            truncated: state.truncated().into(),
            confirmed: state.confirmed_count() as u32,
            informed: state.informed_count() as u32,
            reserved: 0,
            seed: state.seed(),
            carbon_intensity_mg_per_kwh: state.carbon_intensity_mg_per_kwh(),
            billed_intensity_mg_per_kwh: state.billed_intensity_mg_per_kwh(),
            co2_ng: state.co2_ng(),
            grid_uj: state.grid_uj(),
            mean_throughput: state.mean_throughput(),
        }
    }
}

impl jcas_uav {
    pub(crate) fn of(state: &StateRef<'_>, i: usize) -> Self {
        let cell = state.cell(i);
        Self {
            x: cell.x,
            y: cell.y,
            moved: state.moved(i).into(),
            grounded: state.grounded(i).into(),
            returning: state.returning(i).into(),
            neighbours: jcas_core::bits::count(state.links_of(i)) as u32,
            known: jcas_core::bits::count(state.knowledge_of(i)) as u32,
            reserved: 0,
            battery_uj: state.battery_uj(i),
            initial_uj: state.initial_uj(i),
            accepted_uj: state.accepted_uj(i),
            spent_uj: state.spent_uj(i),
            shortfall_uj: state.shortfall_uj(i),
            pilot_density: state.pilot_density(i),
            throughput: state.throughput(i),
            given_uj: state.given_uj(i),
        }
    }
}

impl jcas_hotspot {
    pub(crate) fn of(state: &StateRef<'_>, j: usize) -> Self {
        let cell = state.hotspot_cell(j);
        Self {
            x: cell.x,
            y: cell.y,
            confirmed: state.confirmed(j).into(),
            informed: state.informed(j).into(),
            confirmed_at: state.confirmed_at(j).unwrap_or(0),
            informed_at: state.informed_at(j).unwrap_or(0),
        }
    }
}

impl jcas_metrics {
    pub(crate) fn of(metrics: &Metrics) -> Self {
        Self {
            struct_size: Self::SIZE,
            steps: metrics.steps,
            terminated: metrics.terminated.into(),
            truncated: metrics.truncated.into(),
            confirmed: metrics.confirmed,
            informed: metrics.informed,
            moves: metrics.moves,
            return_sum: metrics.return_sum,
            energy_kwh: metrics.energy_kwh,
            accepted_kwh: metrics.accepted_kwh,
            shortfall_kwh: metrics.shortfall_kwh,
            grid_kwh: metrics.grid_kwh,
            co2_kg: metrics.co2_kg,
            throughput_mean: metrics.throughput_mean,
            pilot_density_mean: metrics.pilot_density_mean,
            false_confirmations: metrics.false_confirmations.into(),
        }
    }
}
