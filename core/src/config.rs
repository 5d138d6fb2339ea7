//! The configuration: every decision of the model as one flat, validated record.

mod choices;
mod depots;
mod detection_table;
mod field;
mod list;
#[cfg(feature = "text")]
pub mod text;
mod validate;

pub use choices::{
    ChargeBilling, DetectionCurve, InformPayment, LearnedDetections, MapDirections, MotionMap,
    PilotGain, Preset, QuorumWindow, SearchMaps, StartCells, TargetVisibility, UavTag, UnknownName,
};
pub use depots::{Cell, Depots, MAX_DEPOTS};
pub use detection_table::{DetectionPoint, DetectionTable, MAX_DETECTION_POINTS};
pub use field::{FieldInfo, FieldValue, FieldValues};
pub use list::{Element, List};

use crate::words::hash::Fnv1a;
use field::Field;

/// Declares the configuration once: the record, its defaults and the description of each field.
macro_rules! configuration {
    // `$d` is a dollar sign for the macro that is defined inside.
    ($d:tt $(
        $(#[doc = $doc:literal])+
        $name:ident: $type:ty = $default:expr, $unit:literal, $low:literal..=$high:literal;
    )+) => {
        /// The configuration of a model. Energies are per UAV; each field has its unit and legal
        /// range.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(
            feature = "serde",
            derive(serde::Deserialize),
            serde(default, deny_unknown_fields)
        )]
        pub struct Config {
            $(
                $(#[doc = $doc])+
                #[doc = concat!(
                    "\n\nUnit: ", $unit,
                    ". Legal: ", stringify!($low), " to ", stringify!($high), "."
                )]
                pub $name: $type,
            )+
        }

        /// Passes the name and the type of each field, in the record's order, to another macro.
        #[macro_export]
        macro_rules! for_each_config_field {
            ($d each:ident) => {
                $d each! { $( $name: $type; )+ }
            };
        }

        impl Config {
            /// The default: the `mission` preset.
            const MISSION: Self = Self { $( $name: $default, )+ };

            /// Number of fields.
            pub const FIELD_COUNT: usize = [$( stringify!($name) ),+].len();

            /// Name, unit, bounds and meaning of each field, in the order of the record.
            pub const FIELDS: [FieldInfo; Self::FIELD_COUNT] = [
                $( FieldInfo {
                    name: stringify!($name),
                    unit: $unit,
                    low: $low as f64,
                    high: $high as f64,
                    doc: concat!($($doc),+),
                }, )+
            ];

            /// The value of each field, in the order of [`Config::FIELDS`].
            #[must_use]
            pub fn values(&self) -> FieldValues<'_> {
                [ $( self.$name.field_value(), )+ ]
            }

            /// Replaces the field at an index of [`Config::FIELDS`]. Returns `false` if the value
            /// has another type.
            #[cfg(feature = "text")]
            pub(crate) fn set_value(&mut self, index: usize, value: &text::TextValue<'_>) -> bool {
                let mut _position = 0;
                $(
                    if index == _position {
                        return Field::read(value).map(|value| self.$name = value).is_some();
                    }
                    _position += 1;
                )+
                false
            }
        }
    };
}

configuration! { $
    /// Cells of the grid along x (W).
    grid_width: u32 = 12, "cells", 1..=1024;
    /// Cells of the grid along y (H).
    grid_height: u32 = 12, "cells", 1..=1024;
    /// Side of a square cell (d).
    cell_size_m: f64 = 50.0, "m", 0.001..=1e6;
    /// UAVs in the fleet (N).
    uav_count: u32 = 10, "UAVs", 1..=4096;
    /// Waste hotspots to find (n).
    hotspot_count: u32 = 5, "hotspots", 1..=4096;
    /// Steps after which an unfinished episode is truncated (T_max).
    horizon_steps: u32 = 100, "steps", 1..=1000000;
    /// Positive detections that confirm a hotspot (θ).
    quorum: u32 = 3, "UAVs", 1..=4096;
    /// Cells with a depot; by default the fleet starts at the first. Empty: one at (W/2, H/2).
    depots: Depots = Depots::CENTRE, "cells", 0..=16;
    /// Lowest state of charge at the start; drawn per UAV, uniformly.
    initial_soc_min: f64 = 1.0, "fraction", 0..=1;
    /// Highest state of charge at the start.
    initial_soc_max: f64 = 1.0, "fraction", 0..=1;
    /// Whether UAVs see hotspots that they do not know: `known` (the paper) or `hidden` (a search).
    target_visibility: TargetVisibility = TargetVisibility::Known, "known | hidden", 0..=1;
    /// Neighbours in an observation, nearest first; at most N - 1 are ever used.
    neighbour_slots: u32 = 4095, "UAVs", 0..=4095;

    /// Carrier frequency (f_c).
    carrier_frequency_hz: f64 = 5.8e9, "Hz", 1e6..=1e13;
    /// Bandwidth of the waveform (B).
    bandwidth_hz: f64 = 100e6, "Hz", 1e3..=1e12;
    /// Transmit power of a UAV (P_t).
    transmit_power_dbm: f64 = 20.0, "dBm", -100..=100;
    /// Transmit antenna gain (G_t).
    transmit_gain_dbi: f64 = 2.0, "dBi", -100..=100;
    /// Receive antenna gain (G_r).
    receive_gain_dbi: f64 = 2.0, "dBi", -100..=100;
    /// Radar cross section of a hotspot (σ_j).
    radar_cross_section_dbsm: f64 = 0.0, "dBsm", -100..=100;
    /// Noise power of the radar receiver (P_n).
    sensing_noise_dbm: f64 = -90.0, "dBm", -200..=100;
    /// Processing gain of coherent OFDM combining (G_proc).
    processing_gain_db: f64 = 8.0, "dB", -100..=100;
    /// Loss of sensing SNR per unit of communication load (α_JCAS).
    comm_load_penalty_db: f64 = 1.0, "dB", 0..=20;
    /// Single-pulse probability of detection that defines the threshold (Albersheim's equation).
    detection_probability: f64 = 0.9, "probability", 0.1..=0.9;
    /// Single-pulse probability of false alarm (P_fa) that defines the threshold, or the curve
    /// `swerling1`.
    false_alarm_probability: f64 = 1e-6, "probability", 1e-12..=0.1;
    /// Detection threshold (γ_det); derived by Albersheim's equation where absent.
    detection_threshold_db: Option<f64> = None, "dB", -300..=300;
    /// Slope of the logistic detection curve (κ).
    logistic_slope_per_db: f64 = 0.25, "1/dB", 0..=10;
    /// Distances below this count as this, for radar and link (R_min); half a cell where absent.
    range_min_m: Option<f64> = None, "m", 0.001..=1e6;
    /// Range resolution (δ) in the penalty 10 log10(1 + δ/R). Where absent: c/(2B). 0 stands for
    /// no penalty.
    range_resolution_m: Option<f64> = None, "m", 0..=1e6;
    /// Lowest pilot density (ρ_min).
    pilot_density_min: f64 = 0.01, "fraction", 0..=1;
    /// Highest pilot density (ρ_max).
    pilot_density_max: f64 = 0.30, "fraction", 0.0001..=1;

    /// Exponent of the log-distance path loss (n).
    path_loss_exponent: f64 = 2.0, "dimensionless", 0.5..=8;
    /// Noise power of the communication receiver (P_n,comm).
    comm_noise_dbm: f64 = -90.0, "dBm", -200..=100;
    /// Spectral efficiency that counts as throughput 1.
    reference_spectral_efficiency: f64 = 6.0, "bit/s/Hz", 0.001..=1000;
    /// Normalised throughput that a link needs in both directions (η_link).
    link_throughput_min: f64 = 1.0, "normalised", 0..=1000;

    /// Duration of a step (Δt).
    step_duration_s: f64 = 10.0, "s", 0.001..=86400;
    /// Battery capacity (B_max).
    battery_capacity_kwh: f64 = 0.20, "kWh", 1e-6..=100;
    /// A battery below this at the start of a step sends the UAV to the nearest depot. 0 turns the
    /// rule off.
    rtb_threshold_kwh: f64 = 0.04, "kWh", 0..=100;
    /// Charging power at a depot (r_ch).
    charge_power_kw: f64 = 0.30, "kW", 0..=10000;
    /// Energy of a step that changes the cell (e_move).
    move_energy_kwh: f64 = 8e-4, "kWh", 0..=1;
    /// Energy of a step in place.
    hover_energy_kwh: f64 = 0.0, "kWh", 0..=1;
    /// Energy of sensing at the highest pilot density for a step (e_sense).
    sense_energy_kwh: f64 = 2e-4, "kWh", 0..=1;
    /// Energy of communicating with the whole waveform for a step (e_comm).
    comm_energy_kwh: f64 = 5e-5, "kWh", 0..=1;
    /// Share of renewable energy in charging (ρ_RE).
    renewable_share: f64 = 0.1, "fraction", 0..=1;
    /// Lowest carbon intensity of grid energy.
    carbon_intensity_min_kg_per_kwh: f64 = 0.25, "kg/kWh", 0..=10;
    /// Highest carbon intensity of grid energy.
    carbon_intensity_max_kg_per_kwh: f64 = 0.40, "kg/kWh", 0..=10;
    /// What charging bills: `accepted` (what the battery took) or `nameplate` (r_ch, the paper's
    /// letter).
    charge_billing: ChargeBilling = ChargeBilling::Accepted, "accepted | nameplate", 0..=1;

    /// Reward of a confirmation (α_det).
    reward_detect: f64 = 7.0, "reward", -1e6..=1e6;
    /// Reward of an informed hotspot (α_inf).
    reward_inform: f64 = 4.0, "reward", -1e6..=1e6;
    /// When an informed hotspot pays: `once`, or at `every_step` after (the paper's letter).
    inform_payment: InformPayment = InformPayment::Once, "once | every_step", 0..=1;
    /// Reward of completion (α_comp).
    reward_complete: f64 = 10.0, "reward", -1e6..=1e6;
    /// Reward of covering the whole grid for the first time (α_cov).
    reward_coverage: f64 = 0.5, "reward", -1e6..=1e6;
    /// Penalty of energy spent (η_e).
    penalty_energy_per_kwh: f64 = 0.2, "reward/kWh", -1e6..=1e6;
    /// Penalty of carbon emitted (η_c).
    penalty_carbon_per_kg: f64 = 0.1, "reward/kg", -1e6..=1e6;
    /// Penalty of a move into a cell visited before (ξ_rev).
    penalty_revisit: f64 = 0.01, "reward", -1e6..=1e6;
    /// Penalty at the horizon (ξ_trunc).
    penalty_truncation: f64 = 0.4, "reward", -1e6..=1e6;
    /// Reward of mean normalised throughput (ζ_comm).
    reward_throughput: f64 = 0.5, "reward", -1e6..=1e6;
    /// Reward of knowledge spread (ζ_spread).
    reward_spread: f64 = 0.1, "reward", -1e6..=1e6;
    /// Discount of the shaping potentials (γ_s).
    shaping_discount: f64 = 0.95, "dimensionless", 0..=1;
    /// Weight of the distance-to-hotspot potential (w_g).
    shaping_goal_weight: f64 = 1.0, "reward", 0..=1e6;
    /// Weight of the carbon-aware charging potential (w_c).
    shaping_charge_weight: f64 = 0.1, "reward", 0..=1e6;

    /// Whether each UAV keeps a map of the cells that it knows to have been looked at: `off` or
    /// `shared`.
    search_maps: SearchMaps = SearchMaps::Off, "off | shared", 0..=1;
    /// A UAV has looked at the cells whose centre is at most this far from its own.
    search_map_radius_m: f64 = 100.0, "m", 0..=1e6;
    /// Observations show the map and the reports this many cells around the UAV; 0: not at all.
    map_window_radius: u32 = 0, "cells", 0..=32;
    /// Whether observations show how much is unsearched in eight directions: `off` or `shown`.
    map_directions: MapDirections = MapDirections::Off, "off | shown", 0..=1;
    /// What tells UAVs in one cell apart: nothing (`off`) or its `index`.
    uav_tag: UavTag = UavTag::Off, "off | index", 0..=1;
    /// Weight of each unconfirmed hotspot in the potential of w_g (w_u), in longest ways over the
    /// grid. From 1 on, a confirmation never lowers the potential.
    shaping_unconfirmed_weight: f64 = 1.0, "longest ways", 0..=1000;
    /// The threshold (γ_det) is the sensing SNR at this distance, before the load's penalty. An
    /// explicit threshold takes precedence.
    sensing_range_m: Option<f64> = None, "m", 0.001..=1e6;

    /// What the pilot density adds to the sensing SNR: nothing (`none`, the paper) or
    /// 10 log10(ρ/ρ_max) (`coherent`).
    pilot_gain: PilotGain = PilotGain::None, "none | coherent", 0..=1;
    /// Probability of detection: `logistic` (the paper) or `swerling1` (a fluctuating echo) over
    /// the sensing SNR, or the `table` over the range.
    detection_curve: DetectionCurve = DetectionCurve::Logistic,
        "logistic | swerling1 | table", 0..=2;
    /// Probability of a false alarm, for each step and cell of a UAV's footprint that holds no
    /// hotspot. 0 stands for no false alarms.
    false_alarm_per_cell: f64 = 0.0, "probability", 0..=0.5;
    /// A UAV may raise false alarms in the cells whose centre is at most this far from its own
    /// (footprint). Where absent: the sensing range, or the range at which P_d is 0.5 at ρ_max.
    sensing_footprint_m: Option<f64> = None, "m", 0..=1e6;
    /// Reward of a false confirmation: at least θ UAVs see a hotspot in one cell that holds none.
    reward_false_confirmation: f64 = 0.0, "reward", -1e6..=1e6;
    /// Levels of the reports that UAVs share. Level ℓ has the cells in which one UAV saw a hotspot,
    /// true or false, in at least ℓ steps. 0 stands for no reports.
    report_levels: u32 = 0, "levels", 0..=3;
    /// Number of reported cells in an observation, nearest first.
    report_slots: u32 = 0, "cells", 0..=64;
    /// Table of the curve `table`: pairs of a range in m and P_d at the highest pilot density.
    detection_table: DetectionTable = DetectionTable::EMPTY, "pairs", 0..=64;
    /// Positive detections that count toward the quorum: those of the present `step` (the paper),
    /// or of the `episode` so far, one from each UAV.
    quorum_window: QuorumWindow = QuorumWindow::Step, "step | episode", 0..=1;
    /// Hotspots that a UAV learns by its own detection: those `confirmed` by a quorum, or `all`. An
    /// episode then ends when all UAVs know all hotspots and each hotspot is confirmed.
    learned_detections: LearnedDetections = LearnedDetections::Confirmed, "confirmed | all", 0..=1;
    /// Cells in which UAVs start: the first `depot`, or a `random` cell of the grid for each UAV.
    start_cells: StartCells = StartCells::Depot, "depot | random", 0..=1;
    /// Order of the motions over the five bins of u_dir: up, down, left, right, stay (`udlrs`), or
    /// up, left, stay, right, down (`symmetric`).
    motion_map: MotionMap = MotionMap::Udlrs, "udlrs | symmetric", 0..=1;
}

impl Default for Config {
    fn default() -> Self {
        Self::MISSION
    }
}

impl Config {
    /// The configuration of a preset.
    #[must_use]
    pub fn preset(preset: Preset) -> Self {
        match preset {
            Preset::Mission => Self::MISSION,
            Preset::Paper => Self {
                charge_billing: ChargeBilling::Nameplate,
                inform_payment: InformPayment::EveryStep,
                sensing_range_m: Some(150.0),
                ..Self::MISSION
            },
            Preset::Search => Self {
                target_visibility: TargetVisibility::Hidden,
                sensing_range_m: Some(150.0),
                reward_coverage: 36.0,
                reward_complete: 50.0,
                reward_throughput: 0.0,
                reward_spread: 0.0,
                shaping_goal_weight: 0.0,
                search_maps: SearchMaps::Shared,
                map_window_radius: 4,
                map_directions: MapDirections::Shown,
                uav_tag: UavTag::Index,
                ..Self::MISSION
            },
            Preset::Isac => Self {
                sensing_range_m: None,
                sensing_noise_dbm: -127.27,
                pilot_gain: PilotGain::Coherent,
                detection_curve: DetectionCurve::Swerling1,
                false_alarm_per_cell: 0.01,
                report_levels: 2,
                report_slots: 8,
                ..Self::preset(Preset::Search)
            },
        }
    }

    /// Number of cells of the grid, W · H.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.grid_width as usize * self.grid_height as usize
    }

    /// The depots in force: those given, or the one at (W/2, H/2).
    #[must_use]
    pub fn effective_depots(&self) -> Depots {
        if self.depots.is_empty() {
            Depots::one(Cell {
                x: self.grid_width / 2,
                y: self.grid_height / 2,
            })
        } else {
            self.depots
        }
    }

    /// Description and value of each field that a text of this configuration states, in order.
    /// Left out are those that are derived from others, for which TOML has no value.
    pub fn stated(&self) -> impl Iterator<Item = (&'static FieldInfo, FieldValue<'_>)> {
        let fields = Self::FIELDS.iter().zip(self.values());
        fields.filter(|(_, value)| !value.is_derived())
    }

    /// FNV-1a hash of every field, which is equal for configurations that are equal field by field.
    #[must_use]
    pub fn hash(&self) -> u64 {
        let mut hash = Fnv1a::new();
        for value in self.values() {
            value.write(&mut hash);
        }
        hash.finish()
    }
}

/// Writes the fields that a text states, see [`Config::stated`].
#[cfg(feature = "serde")]
impl serde::Serialize for Config {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.stated().map(|(info, value)| (info.name, value)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_field_has_a_part_in_the_hash() {
        let config = Config::default();
        let changed = [
            Config {
                grid_width: 13,
                ..config
            },
            Config {
                range_min_m: Some(0.0),
                ..config
            },
            Config {
                depots: Depots::one(Cell { x: 6, y: 6 }),
                ..config
            },
            Config {
                motion_map: MotionMap::Symmetric,
                ..config
            },
        ];
        for changed in changed {
            assert_ne!(changed.hash(), config.hash());
        }
    }

    #[test]
    fn a_text_states_every_field_that_is_not_derived() {
        let config = Config::default();
        let stated = config.stated().count();
        let derived = config
            .values()
            .into_iter()
            .filter(|value| value.is_derived());
        assert_eq!(stated + derived.count(), Config::FIELD_COUNT);
        assert!(config.stated().any(|(info, _)| info.name == "motion_map"));
    }
}
