//! The model of `docs/model.md`, written a second time.
//!
//! The kernel is fast: bit words, tables over cell offsets, caller memory. This
//! module is the opposite on purpose. Every set is a `Vec<bool>`. Every radar and
//! link value is computed from its equation, once for each distance that two cells
//! of the grid can have. Consensus is the paper's iterations, and the random
//! generator is written from its publication. It shares the kernel's [`Config`] and
//! nothing else. So only a mistake that is made in both, in two different ways,
//! is missed by `tests/differential.rs`.

mod alarms;
mod distances;
pub mod draws;
mod energy;
mod host;
mod link;
mod observation;
pub mod philox;
mod potential;
mod radar;
mod reports;
mod reset;
mod reward;
mod search;
mod step;

pub use energy::Ledger;
pub use host::Host;
pub use reward::Rewards;
pub use step::motion;

use distances::ByDistance;
use jcas_core::Config;

/// Metres a second, exact by the definition of the metre.
const SPEED_OF_LIGHT_M_PER_S: f64 = 299_792_458.0;

/// A cell of the grid as signed numbers, so that differences may be negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Position {
    /// Column, 0 at the left.
    pub x: i64,
    /// Row, 0 at the bottom.
    pub y: i64,
}

impl Position {
    /// Returns the Manhattan distance in cells.
    fn manhattan(self, other: Position) -> i64 {
        (self.x - other.x).abs() + (self.y - other.y).abs()
    }

    /// Returns the squared Euclidean distance, in square cells.
    fn squared(self, other: Position) -> i64 {
        let (dx, dy) = (self.x - other.x, self.y - other.y);
        dx * dx + dy * dy
    }
}

/// The rules of one mission: the configuration and quantities that follow directly from it.
#[derive(Clone, Debug)]
pub struct Specification {
    /// The configuration, as the kernel takes it.
    pub config: Config,
    /// Charging cells; never empty.
    pub depots: Vec<Position>,
    /// Energies in microjoules.
    pub energy: Ledger,
    /// SNR^sens in dB before communication load, or the logit of P_d by a table.
    by_range: ByDistance,
    /// log2(1 + SNR^comm), in bit/s/Hz.
    spectral_efficiency: ByDistance,
    /// γ_det in dB.
    detection_threshold_db: f64,
    /// Radius of a footprint, in metres.
    footprint_m: f64,
}

/// Everything that changes during a mission.
#[derive(Clone, Debug)]
pub struct World {
    /// The episode's seed.
    pub seed: u64,
    /// Steps made so far.
    pub t: u32,
    /// Cell of each UAV.
    pub position: Vec<Position>,
    /// Battery of each UAV at the start of the episode, in microjoules.
    pub initial_uj: Vec<u64>,
    /// Battery of each UAV, in microjoules.
    pub battery_uj: Vec<u64>,
    /// Energy that each UAV has used so far, in microjoules.
    pub spent_uj: Vec<u64>,
    /// Energy that each battery has taken at depots so far, in microjoules.
    pub accepted_uj: Vec<u64>,
    /// What a host has put into each battery, less what it has taken out, in microjoules.
    pub given_uj: Vec<i64>,
    /// Energy that each UAV requested beyond its charge so far, in microjoules.
    pub shortfall_uj: Vec<u64>,
    /// Pilot density of each UAV.
    pub pilot: Vec<f64>,
    /// Mean normalised throughput of each UAV toward its neighbours.
    pub throughput: Vec<f64>,
    /// Whether each UAV was without charge at the start of the last step.
    pub grounded: Vec<bool>,
    /// Whether a low battery sent each UAV back to base in the last step.
    pub returning: Vec<bool>,
    /// Whether each UAV changed its cell in the last step.
    pub moved: Vec<bool>,
    /// `linked[i][k]`: UAVs i and k hear each other in the last step.
    pub linked: Vec<Vec<bool>>,
    /// Cell of each hotspot.
    pub hotspot: Vec<Position>,
    /// `detected[i][j]`: UAV i detected hotspot j when it last sensed.
    pub detected: Vec<Vec<bool>>,
    /// `knows[i][j]`: the paper's k_ij.
    pub knows: Vec<Vec<bool>>,
    /// Step at which each hotspot was confirmed.
    pub confirmed_at: Vec<Option<u32>>,
    /// Step at which each hotspot became known to every UAV.
    pub informed_at: Vec<Option<u32>>,
    /// `visited[y][x]`: some UAV has been there.
    pub visited: Vec<Vec<bool>>,
    /// `searched[i][y][x]`: UAV i knows that the cell has been looked at; never without search
    /// maps.
    pub searched: Vec<Vec<Vec<bool>>>,
    /// The cells in which each UAV raised a false alarm when it last sensed.
    pub false_alarms: Vec<Vec<Position>>,
    /// `falsely_confirmed[y][x]`: a quorum saw a hotspot in a cell that held none.
    pub falsely_confirmed: Vec<Vec<bool>>,
    /// Cells that were falsely confirmed when the fleet last sensed.
    pub newly_false: u32,
    /// `sightings[i][y][x]`: in how many steps UAV i saw a hotspot in the cell, true or false.
    pub sightings: Vec<Vec<Vec<u32>>>,
    /// `reported[i][y][x]`: the most sightings of one UAV that UAV i knows of, up to the number of
    /// levels.
    pub reported: Vec<Vec<Vec<u32>>>,
    /// `remembered[i][j]`: UAV i counts toward the quorum of hotspot j, by its detections of the
    /// step or of the episode.
    pub remembered: Vec<Vec<bool>>,
    /// `remembered_false[i][y][x]`: UAV i counts toward the false confirmation of the cell.
    pub remembered_false: Vec<Vec<Vec<bool>>>,
    /// Carbon intensity that the coming step will be billed with, in mg/kWh.
    pub coming_intensity_mg_per_kwh: u64,
    /// Carbon intensity that the last step was billed with, in mg/kWh.
    pub billed_intensity_mg_per_kwh: u64,
    /// Grid energy so far, in microjoules.
    pub grid_uj: u64,
    /// Carbon dioxide so far, in nanograms.
    pub co2_ng: u64,
    /// Mean of `throughput` over all UAVs: the paper's η̄(t).
    pub mean_throughput: f64,
    /// The last step's reward, term by term.
    pub rewards: Rewards,
    /// The last step's reward of each UAV, term by term.
    pub uav_rewards: Vec<Rewards>,
    /// Whether every hotspot is confirmed and informed.
    pub terminated: bool,
    /// Whether the horizon was reached before that.
    pub truncated: bool,
}

impl Specification {
    /// Reads the rules from a valid configuration.
    pub fn new(config: &Config) -> Self {
        let mut depots = Vec::new();
        for cell in config.depots.as_slice() {
            depots.push(Position {
                x: i64::from(cell.x),
                y: i64::from(cell.y),
            });
        }
        if depots.is_empty() {
            let x = i64::from(config.grid_width / 2);
            let y = i64::from(config.grid_height / 2);
            depots.push(Position { x, y });
        }
        let mut specification = Specification {
            config: *config,
            depots,
            energy: Ledger::new(config),
            by_range: ByDistance::new(config, radar::by_range),
            spectral_efficiency: ByDistance::new(config, link::spectral_efficiency),
            detection_threshold_db: radar::detection_threshold_db(config),
            footprint_m: 0.0,
        };
        specification.footprint_m = specification.footprint_radius_m();
        specification
    }

    fn uavs(&self) -> usize {
        self.config.uav_count as usize
    }

    fn hotspots(&self) -> usize {
        self.config.hotspot_count as usize
    }

    fn width(&self) -> i64 {
        i64::from(self.config.grid_width)
    }

    fn height(&self) -> i64 {
        i64::from(self.config.grid_height)
    }

    /// Longest Manhattan distance on the grid, W + H − 2.
    fn longest_path(&self) -> f64 {
        (self.width() + self.height() - 2) as f64
    }

    fn is_depot(&self, position: Position) -> bool {
        self.depots.contains(&position)
    }

    /// The nearest depot by Manhattan distance; the first listed one on a tie.
    fn nearest_depot(&self, position: Position) -> Position {
        let mut best = self.depots[0];
        for &depot in &self.depots {
            if position.manhattan(depot) < position.manhattan(best) {
                best = depot;
            }
        }
        best
    }
}

/// Returns a / b, and 0 where b is 0.
fn fraction(a: f64, b: f64) -> f64 {
    if b == 0.0 { 0.0 } else { a / b }
}
