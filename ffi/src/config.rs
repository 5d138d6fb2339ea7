//! The configuration as a C struct.

use jcas_core::config::{
    Cell, Config, Depots, DetectionPoint, DetectionTable, MAX_DEPOTS, MAX_DETECTION_POINTS,
};
use jcas_core::error::{Allowed, ConfigError, Value};
use jcas_core::{
    ChargeBilling, DetectionCurve, InformPayment, LearnedDetections, MapDirections, MotionMap,
    PilotGain, QuorumWindow, SearchMaps, StartCells, TargetVisibility, UavTag,
};

use crate::memory::{Plain, Record};

/// The largest number of depots in a configuration.
pub const JCAS_MAX_DEPOTS: usize = 16;
/// UAVs observe the position of every hotspot, as in the paper.
pub const JCAS_VISIBILITY_KNOWN: i32 = 0;
/// UAVs observe the positions of the hotspots that they know, and must search for the others.
pub const JCAS_VISIBILITY_HIDDEN: i32 = 1;
/// Charging bills what the battery accepted.
pub const JCAS_BILLING_ACCEPTED: i32 = 0;
/// Charging bills the charger's rating whenever a UAV is on a depot, as in the paper.
pub const JCAS_BILLING_NAMEPLATE: i32 = 1;
/// An informed hotspot pays at the step at which it becomes informed.
pub const JCAS_PAYMENT_ONCE: i32 = 0;
/// An informed hotspot pays at that step and every later one, as in the paper.
pub const JCAS_PAYMENT_EVERY_STEP: i32 = 1;
/// UAVs keep no search maps.
pub const JCAS_MAPS_OFF: i32 = 0;
/// Each UAV keeps a map of the cells that it knows to be searched; maps spread with knowledge.
pub const JCAS_MAPS_SHARED: i32 = 1;
/// Observations do not show how much is unsearched in each direction.
pub const JCAS_DIRECTIONS_OFF: i32 = 0;
/// Observations show how much is unsearched in each of eight directions.
pub const JCAS_DIRECTIONS_SHOWN: i32 = 1;
/// Observations do not distinguish UAVs in one cell.
pub const JCAS_TAG_OFF: i32 = 0;
/// Observations end with the UAV's index over N - 1.
pub const JCAS_TAG_INDEX: i32 = 1;
/// The pilot density adds nothing to the sensing SNR, as in the paper.
pub const JCAS_PILOT_GAIN_NONE: i32 = 0;
/// The radar integrates its pilots coherently: the SNR gains 10 log10(ρ/ρ_max) dB.
pub const JCAS_PILOT_GAIN_COHERENT: i32 = 1;
/// The probability of detection is the paper's logistic function of the margin.
pub const JCAS_CURVE_LOGISTIC: i32 = 0;
/// The probability of detection is that of a Swerling-1 echo in one look.
pub const JCAS_CURVE_SWERLING1: i32 = 1;
/// The probability of detection is a table over the range.
pub const JCAS_CURVE_TABLE: i32 = 2;
/// The quorum counts the positive detections of one step, as in the paper.
pub const JCAS_QUORUM_STEP: i32 = 0;
/// The quorum counts the UAVs that have detected the hotspot in the episode so far.
pub const JCAS_QUORUM_EPISODE: i32 = 1;
/// A UAV learns the hotspots that it detected and that are confirmed.
pub const JCAS_LEARNED_CONFIRMED: i32 = 0;
/// A UAV learns all hotspots that it detected.
pub const JCAS_LEARNED_ALL: i32 = 1;
/// All UAVs start at the first depot.
pub const JCAS_START_DEPOT: i32 = 0;
/// Each UAV starts in a cell drawn from the whole grid.
pub const JCAS_START_RANDOM: i32 = 1;
/// The bins of u_dir are up, down, left, right, stay.
pub const JCAS_MOTIONS_UDLRS: i32 = 0;
/// The bins of u_dir are up, left, stay, right, down.
pub const JCAS_MOTIONS_SYMMETRIC: i32 = 1;
/// The largest number of points of a detection table.
pub const JCAS_MAX_DETECTION_POINTS: usize = 64;

const _: () = assert!(JCAS_MAX_DEPOTS == MAX_DEPOTS);
const _: () = assert!(JCAS_MAX_DETECTION_POINTS == MAX_DETECTION_POINTS);

/// A cell of the grid: x in 0..W, y in 0..H.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct jcas_cell {
    /// Column.
    pub x: u32,
    /// Row; up is +y.
    pub y: u32,
}

// SAFETY: two integers.
unsafe impl Plain for jcas_cell {}

/// A point of a detection table.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct jcas_detection_point {
    /// Distance between UAV and hotspot. [m, 0 to 1e6]
    pub range_m: f64,
    /// Probability of detection (P_d) at the highest pilot density. [probability, above 0 and below
    /// 1]
    pub probability: f64,
}

// SAFETY: two floats.
unsafe impl Plain for jcas_detection_point {}

/// The configuration of a model. Fill it by jcas_config_default or another function that fills it,
/// then change fields. Each field states [unit, legal range; default]. Symbols are those of the
/// paper.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct jcas_config {
    /// sizeof(jcas_config).
    pub struct_size: u32,
    /// Cells of the grid along x (W). [cells, 1 to 1024; default 12]
    pub grid_width: u32,
    /// Cells of the grid along y (H). [cells, 1 to 1024; default 12]
    pub grid_height: u32,
    /// Side of a square cell (d). [m, 0.001 to 1e6; default 50]
    pub cell_size_m: f64,
    /// UAVs in the fleet (N). [UAVs, 1 to 4096; default 10]
    pub uav_count: u32,
    /// Waste hotspots to find (n). [hotspots, 1 to 4096; default 5]
    pub hotspot_count: u32,
    /// Steps after which an unfinished episode is truncated (T_max). [steps, 1 to 1000000; default
    /// 100]
    pub horizon_steps: u32,
    /// Positive detections that confirm a hotspot (θ), in one step by default; above N none ever
    /// is. [UAVs, 1 to 4096; default 3]
    pub quorum: u32,
    /// Number of depots, 0 to JCAS_MAX_DEPOTS. 0 (default): one depot, at (W/2, H/2).
    pub depot_count: u32,
    /// Cells with a depot; the fleet starts at the first. Those beyond depot_count are not read.
    pub depots: [jcas_cell; JCAS_MAX_DEPOTS],
    /// Lowest state of charge at the start; drawn per UAV, uniformly. [fraction, 0 to 1; default 1]
    pub initial_soc_min: f64,
    /// Highest state of charge at the start. [fraction, 0 to 1; default 1]
    pub initial_soc_max: f64,
    /// What UAVs see of hotspots that they do not know: JCAS_VISIBILITY_KNOWN (default) or
    /// JCAS_VISIBILITY_HIDDEN.
    pub target_visibility: i32,
    /// Neighbours in an observation, nearest first; at most N - 1 are ever used. [UAVs, 0 to 4095;
    /// default 4095]
    pub neighbour_slots: u32,
    /// Carrier frequency (f_c). [Hz, 1e6 to 1e13; default 5.8e9]
    pub carrier_frequency_hz: f64,
    /// Bandwidth of the waveform (B). [Hz, 1e3 to 1e12; default 100e6]
    pub bandwidth_hz: f64,
    /// Transmit power of a UAV (P_t). [dBm, -100 to 100; default 20]
    pub transmit_power_dbm: f64,
    /// Transmit antenna gain (G_t). [dBi, -100 to 100; default 2]
    pub transmit_gain_dbi: f64,
    /// Receive antenna gain (G_r). [dBi, -100 to 100; default 2]
    pub receive_gain_dbi: f64,
    /// Radar cross section of a hotspot (σ_j). [dBsm, -100 to 100; default 0]
    pub radar_cross_section_dbsm: f64,
    /// Noise power of the radar receiver (P_n). [dBm, -200 to 100; default -90]
    pub sensing_noise_dbm: f64,
    /// Processing gain of coherent OFDM combining (G_proc). [dB, -100 to 100; default 8]
    pub processing_gain_db: f64,
    /// Loss of sensing SNR per unit of communication load (α_JCAS). [dB, 0 to 20; default 1]
    pub comm_load_penalty_db: f64,
    /// Single-pulse probability of detection that defines the threshold (Albersheim's equation).
    /// [probability, 0.1 to 0.9; default 0.9]
    pub detection_probability: f64,
    /// Single-pulse probability of false alarm (P_fa) that defines the threshold, or the curve
    /// JCAS_CURVE_SWERLING1. JCAS_CURVE_LOGISTIC takes 1e-7 to 1e-3. [probability, 1e-12 to 0.1;
    /// default 1e-6]
    pub false_alarm_probability: f64,
    /// Detection threshold (γ_det); JCAS_DERIVED: by Albersheim's equation. [dB, -300 to 300;
    /// default JCAS_DERIVED]
    pub detection_threshold_db: f64,
    /// Slope of the logistic detection curve (κ). [1/dB, 0 to 10; default 0.25]
    pub logistic_slope_per_db: f64,
    /// Distances below this count as this, for radar and link (R_min); JCAS_DERIVED: half a cell.
    /// [m, 0.001 to 1e6; default JCAS_DERIVED]
    pub range_min_m: f64,
    /// Range resolution (δ) in the penalty 10 log10(1 + δ/R); JCAS_DERIVED: c/(2B); 0: no penalty.
    /// [m, 0 to 1e6; default JCAS_DERIVED]
    pub range_resolution_m: f64,
    /// Lowest pilot density (ρ_min). [fraction, 0 to 1; default 0.01]
    pub pilot_density_min: f64,
    /// Highest pilot density (ρ_max). [fraction, 0.0001 to 1; default 0.30]
    pub pilot_density_max: f64,
    /// Exponent of the log-distance path loss (n). [dimensionless, 0.5 to 8; default 2]
    pub path_loss_exponent: f64,
    /// Noise power of the communication receiver (P_n,comm). [dBm, -200 to 100; default -90]
    pub comm_noise_dbm: f64,
    /// Spectral efficiency that counts as throughput 1. [bit/s/Hz, 0.001 to 1000; default 6]
    pub reference_spectral_efficiency: f64,
    /// Normalised throughput that a link needs in both directions (η_link). [normalised, 0 to 1000;
    /// default 1]
    pub link_throughput_min: f64,
    /// Duration of a step (Δt). [s, 0.001 to 86400; default 10]
    pub step_duration_s: f64,
    /// Battery capacity (B_max). [kWh, 1e-6 to 100; default 0.20]
    pub battery_capacity_kwh: f64,
    /// A battery below this at the start of a step sends the UAV to the nearest depot. 0 turns the
    /// rule off. [kWh, 0 to 100; default 0.04]
    pub rtb_threshold_kwh: f64,
    /// Charging power at a depot (r_ch). [kW, 0 to 10000; default 0.30]
    pub charge_power_kw: f64,
    /// Energy of a step that changes the cell (e_move). [kWh, 0 to 1; default 8e-4]
    pub move_energy_kwh: f64,
    /// Energy of a step in place. [kWh, 0 to 1; default 0]
    pub hover_energy_kwh: f64,
    /// Energy of sensing at the highest pilot density for a step (e_sense). [kWh, 0 to 1; default
    /// 2e-4]
    pub sense_energy_kwh: f64,
    /// Energy of communicating with the whole waveform for a step (e_comm). [kWh, 0 to 1; default
    /// 5e-5]
    pub comm_energy_kwh: f64,
    /// Share of renewable energy in charging (ρ_RE). [fraction, 0 to 1; default 0.1]
    pub renewable_share: f64,
    /// Lowest carbon intensity of grid energy. [kg/kWh, 0 to 10; default 0.25]
    pub carbon_intensity_min_kg_per_kwh: f64,
    /// Highest carbon intensity of grid energy. [kg/kWh, 0 to 10; default 0.40]
    pub carbon_intensity_max_kg_per_kwh: f64,
    /// What charging bills: JCAS_BILLING_ACCEPTED (default) or JCAS_BILLING_NAMEPLATE.
    pub charge_billing: i32,
    /// Reward of a confirmation (α_det). [reward, -1e6 to 1e6; default 7]
    pub reward_detect: f64,
    /// Reward of an informed hotspot (α_inf). [reward, -1e6 to 1e6; default 4]
    pub reward_inform: f64,
    /// When an informed hotspot pays: JCAS_PAYMENT_ONCE (default) or JCAS_PAYMENT_EVERY_STEP.
    pub inform_payment: i32,
    /// Reward of completion (α_comp). [reward, -1e6 to 1e6; default 10]
    pub reward_complete: f64,
    /// Reward of covering the whole grid for the first time (α_cov). [reward, -1e6 to 1e6; default
    /// 0.5]
    pub reward_coverage: f64,
    /// Penalty of energy spent (η_e). [reward/kWh, -1e6 to 1e6; default 0.2]
    pub penalty_energy_per_kwh: f64,
    /// Penalty of carbon emitted (η_c). [reward/kg, -1e6 to 1e6; default 0.1]
    pub penalty_carbon_per_kg: f64,
    /// Penalty of a move into a cell visited before (ξ_rev). [reward, -1e6 to 1e6; default 0.01]
    pub penalty_revisit: f64,
    /// Penalty at the horizon (ξ_trunc). [reward, -1e6 to 1e6; default 0.4]
    pub penalty_truncation: f64,
    /// Reward of mean normalised throughput (ζ_comm). [reward, -1e6 to 1e6; default 0.5]
    pub reward_throughput: f64,
    /// Reward of knowledge spread (ζ_spread). [reward, -1e6 to 1e6; default 0.1]
    pub reward_spread: f64,
    /// Discount of the shaping potentials (γ_s). [dimensionless, 0 to 1; default 0.95]
    pub shaping_discount: f64,
    /// Weight of the distance-to-hotspot potential (w_g). [reward, 0 to 1e6; default 1]
    pub shaping_goal_weight: f64,
    /// Weight of the carbon-aware charging potential (w_c). [reward, 0 to 1e6; default 0.1]
    pub shaping_charge_weight: f64,
    /// Whether each UAV keeps a map of the cells that it knows to have been looked at:
    /// JCAS_MAPS_OFF (default) or JCAS_MAPS_SHARED.
    pub search_maps: i32,
    /// A UAV has looked at the cells whose centre is at most this far from its own. [m, 0 to 1e6;
    /// default 100]
    pub search_map_radius_m: f64,
    /// Observations show the map this many cells around the UAV; 0: not at all. [cells, 0 to 32;
    /// default 0]
    pub map_window_radius: u32,
    /// Whether observations show how much is unsearched in eight directions: JCAS_DIRECTIONS_OFF
    /// (default) or JCAS_DIRECTIONS_SHOWN.
    pub map_directions: i32,
    /// What tells UAVs in one cell apart: JCAS_TAG_OFF (default) or JCAS_TAG_INDEX.
    pub uav_tag: i32,
    /// Weight of each unconfirmed hotspot in the potential of w_g (w_u), in longest ways over the
    /// grid. From 1 on, a confirmation never lowers the potential. [longest ways, 0 to 1000;
    /// default 1]
    pub shaping_unconfirmed_weight: f64,
    /// The threshold (γ_det) is the sensing SNR at this distance, before the load's penalty. An
    /// explicit detection_threshold_db takes precedence. JCAS_DERIVED: Albersheim's equation gives
    /// the threshold. [m, 0.001 to 1e6; default JCAS_DERIVED]
    pub sensing_range_m: f64,
    /// What the pilot density adds to the sensing SNR: JCAS_PILOT_GAIN_NONE (default) or
    /// JCAS_PILOT_GAIN_COHERENT.
    pub pilot_gain: i32,
    /// Probability of detection: JCAS_CURVE_LOGISTIC (default) or JCAS_CURVE_SWERLING1 over the
    /// sensing SNR, or JCAS_CURVE_TABLE over the range. The last two refuse a threshold and a
    /// sensing range, and JCAS_CURVE_SWERLING1 refuses a slope.
    pub detection_curve: i32,
    /// Probability of a false alarm, for each step and cell of a UAV's footprint that holds no
    /// hotspot. 0 stands for no false alarms. [probability, 0 to 0.5; default 0]
    pub false_alarm_per_cell: f64,
    /// A UAV may raise false alarms in the cells whose centre is at most this far from its own
    /// (footprint). JCAS_DERIVED: the sensing range, or the range at which the probability of
    /// detection is 0.5 at pilot_density_max. Refused without false alarms. [m, 0 to 1e6; default
    /// JCAS_DERIVED]
    pub sensing_footprint_m: f64,
    /// Reward of a false confirmation: at least θ UAVs see a hotspot in one cell that holds none.
    /// [reward, -1e6 to 1e6; default 0]
    pub reward_false_confirmation: f64,
    /// Levels of the reports that UAVs share. Level l has the cells in which one UAV saw a hotspot,
    /// true or false, in at least l steps. 0 stands for no reports. Refused without false alarms.
    /// [levels, 0 to 3; default 0]
    pub report_levels: u32,
    /// Number of reported cells in an observation, nearest first. Refused without reports.
    /// [cells, 0 to 64; default 0]
    pub report_slots: u32,
    /// Number of points of the detection table, 1 to JCAS_MAX_DETECTION_POINTS with
    /// JCAS_CURVE_TABLE, otherwise 0 (default).
    pub detection_point_count: u32,
    /// Points of ascending range, whose P_d does not rise. Between two of them the logit of P_d is
    /// linear, and beyond the ends it is held. The pilot gain and the load's penalty move the logit
    /// by logistic_slope_per_db. Points beyond detection_point_count are not read.
    pub detection_table: [jcas_detection_point; JCAS_MAX_DETECTION_POINTS],
    /// Positive detections that count toward the quorum: JCAS_QUORUM_STEP (default) or
    /// JCAS_QUORUM_EPISODE. A false confirmation needs the same quorum.
    pub quorum_window: i32,
    /// Hotspots that a UAV learns by its own detection: JCAS_LEARNED_CONFIRMED (default) or
    /// JCAS_LEARNED_ALL. The episode terminates when all UAVs know all hotspots and each hotspot is
    /// confirmed.
    pub learned_detections: i32,
    /// Cells in which UAVs start: JCAS_START_DEPOT (default) or JCAS_START_RANDOM.
    pub start_cells: i32,
    /// Order of the motions over the five bins of u_dir: JCAS_MOTIONS_UDLRS (default) or
    /// JCAS_MOTIONS_SYMMETRIC.
    pub motion_map: i32,
}

// SAFETY: integers and floats only.
unsafe impl Plain for jcas_config {}
// SAFETY: `struct_size` comes first.
unsafe impl Record for jcas_config {}

/// Converts every field of the kernel's record, by its name. A field that only one of the two
/// structs has does not compile.
macro_rules! conversions {
    ($( $name:ident: $type:ty; )+) => {
        impl jcas_config {
            pub(crate) fn from_core(config: &Config) -> Self {
                Self {
                    struct_size: Self::SIZE,
                    depot_count: config.depots.len() as u32,
                    detection_point_count: config.detection_table.len() as u32,
                    $( $name: CField::to_c(config.$name), )+
                }
            }

            /// The same configuration for the kernel, which has yet to validate it.
            pub(crate) fn to_core(self) -> Result<Config, ConfigError> {
                let depots = self.given_depots()?;
                let detection_table = self.given_table()?;
                let config = Config {
                    $( $name: CField::from_c(stringify!($name), self.$name)?, )+
                };
                Ok(Config { depots, detection_table, ..config })
            }
        }
    };
}

jcas_core::for_each_config_field!(conversions);

impl jcas_config {
    fn given_depots(&self) -> Result<Depots, ConfigError> {
        let mut cells = [Cell { x: 0, y: 0 }; JCAS_MAX_DEPOTS];
        for (to, from) in cells.iter_mut().zip(&self.depots) {
            *to = Cell {
                x: from.x,
                y: from.y,
            };
        }
        cells
            .get(..self.depot_count as usize)
            .and_then(Depots::from_slice)
            .ok_or(ConfigError {
                field: "depot_count",
                value: Value::Integer(self.depot_count.into()),
                allowed: Allowed::Range(0.0, JCAS_MAX_DEPOTS as f64),
            })
    }

    fn given_table(&self) -> Result<DetectionTable, ConfigError> {
        let points = self.detection_table.map(|point| DetectionPoint {
            range_m: point.range_m,
            probability: point.probability,
        });
        points
            .get(..self.detection_point_count as usize)
            .and_then(DetectionTable::from_slice)
            .ok_or(ConfigError {
                field: "detection_point_count",
                value: Value::Integer(self.detection_point_count.into()),
                allowed: Allowed::Range(0.0, JCAS_MAX_DETECTION_POINTS as f64),
            })
    }
}

/// The type of a field, in the kernel's record and in the C struct.
trait CField: Sized {
    type C;

    fn to_c(self) -> Self::C;

    fn from_c(name: &'static str, value: Self::C) -> Result<Self, ConfigError>;
}

impl CField for u32 {
    type C = Self;

    fn to_c(self) -> Self {
        self
    }

    fn from_c(_name: &'static str, value: Self) -> Result<Self, ConfigError> {
        Ok(value)
    }
}

impl CField for f64 {
    type C = Self;

    fn to_c(self) -> Self {
        self
    }

    fn from_c(_name: &'static str, value: Self) -> Result<Self, ConfigError> {
        Ok(value)
    }
}

/// NaN means that a real number is derived.
impl CField for Option<f64> {
    type C = f64;

    fn to_c(self) -> f64 {
        self.unwrap_or(f64::NAN)
    }

    fn from_c(_name: &'static str, value: f64) -> Result<Self, ConfigError> {
        Ok((!value.is_nan()).then_some(value))
    }
}

impl CField for Depots {
    type C = [jcas_cell; JCAS_MAX_DEPOTS];

    fn to_c(self) -> Self::C {
        let mut depots = [jcas_cell { x: 0, y: 0 }; JCAS_MAX_DEPOTS];
        for (to, from) in depots.iter_mut().zip(self.as_slice()) {
            *to = jcas_cell {
                x: from.x,
                y: from.y,
            };
        }
        depots
    }

    /// This is None, as the number of depots is in another field.
    fn from_c(_name: &'static str, _cells: Self::C) -> Result<Self, ConfigError> {
        Ok(Self::CENTRE)
    }
}

impl CField for DetectionTable {
    type C = [jcas_detection_point; JCAS_MAX_DETECTION_POINTS];

    fn to_c(self) -> Self::C {
        let mut points = [jcas_detection_point {
            range_m: 0.0,
            probability: 0.0,
        }; JCAS_MAX_DETECTION_POINTS];
        for (to, from) in points.iter_mut().zip(self.as_slice()) {
            *to = jcas_detection_point {
                range_m: from.range_m,
                probability: from.probability,
            };
        }
        points
    }

    /// This is empty, as the number of points is in another field.
    fn from_c(_name: &'static str, _points: Self::C) -> Result<Self, ConfigError> {
        Ok(Self::EMPTY)
    }
}

macro_rules! choices {
    ($( $name:ident ),+) => { $(
        impl CField for $name {
            type C = i32;

            fn to_c(self) -> i32 {
                self as i32
            }

            fn from_c(name: &'static str, value: i32) -> Result<Self, ConfigError> {
                let index = u32::try_from(value).ok();
                index.and_then(Self::from_index).ok_or(ConfigError {
                    field: name,
                    value: Value::Real(f64::from(value)),
                    allowed: Allowed::Rule("one of its constants"),
                })
            }
        }
    )+ };
}

choices!(
    ChargeBilling,
    DetectionCurve,
    InformPayment,
    LearnedDetections,
    MapDirections,
    MotionMap,
    PilotGain,
    QuorumWindow,
    SearchMaps,
    StartCells,
    TargetVisibility,
    UavTag
);
