//! How much of the paper's grid is trained and flown.

use jcas_core::{Config, InformPayment};
use jcas_train::head::Head;
use jcas_train::settings::{Preset, Settings};

/// Size of a reproduction.
#[derive(Clone, Debug)]
pub struct Scale {
    /// Name in reports: `full` or `quick`.
    pub name: &'static str,
    /// Fleet sizes N.
    pub fleets: Vec<u32>,
    /// Numbers of hotspots n.
    pub hotspots: Vec<u32>,
    /// Training seeds.
    pub seeds: Vec<u64>,
    /// Missions for each result.
    pub episodes: u64,
    /// Our settings: one policy for the whole grid.
    pub tuned: Settings,
    /// The paper's settings: one policy for each cell.
    pub paper: Settings,
    /// Cells (N, n) that are trained with the paper's settings.
    pub paper_cells: Vec<(u32, u32)>,
    /// What is changed of the paper's settings, one thing at a time, to see what a result hangs on.
    pub variations: Vec<Variation>,
    /// Held pilot densities of the trade-off.
    pub densities: Vec<f64>,
    /// Renewable shares of the small-battery missions.
    pub renewable_shares: Vec<f64>,
}

/// One change of the paper's model or of its training.
#[derive(Clone, Debug)]
pub struct Variation {
    /// Name in files.
    pub name: &'static str,
    /// What is changed, and what it tests.
    pub tests: &'static str,
    /// The change.
    pub apply: fn(&mut Config, &mut Settings),
}

/// Changes that could explain what PPO learns under the paper's equations.
pub fn variations() -> Vec<Variation> {
    let variation = |name, tests, apply| Variation { name, tests, apply };
    vec![
        variation(
            "inform_once",
            "an informed hotspot pays once, not at every step: finishing late no longer pays more",
            |config, _| config.inform_payment = InformPayment::Once,
        ),
        variation(
            "no_throughput_reward",
            "no reward for throughput, which pays for stalling as well",
            |config, _| config.reward_throughput = 0.0,
        ),
        variation(
            "discount_099",
            "γ = 0.99: a far reward counts",
            |_, settings| settings.discount = 0.99,
        ),
        variation(
            "easier_detection",
            "detection threshold 7 dB, not 13.1: over a hotspot a UAV sees it in every other step",
            |config, _| config.detection_threshold_db = Some(7.0),
        ),
        variation(
            "easier_mission",
            "threshold 7 dB, a quorum of one, no reward for throughput: all three hurdles taken away",
            |config, _| easier(config),
        ),
        variation(
            "easier_mission_inform_once",
            "the same, and an informed hotspot pays once",
            |config, _| {
                easier(config);
                config.inform_payment = InformPayment::Once;
            },
        ),
        variation(
            "hybrid_head",
            "categorical motion and Beta pilot density, not five bins of a normal variable",
            |_, settings| settings.head = Head::Hybrid,
        ),
    ]
}

/// A mission that PPO can stumble upon: one detection is enough, and nothing pays for hovering in contact.
fn easier(config: &mut Config) {
    config.detection_threshold_db = Some(7.0);
    config.quorum = 1;
    config.reward_throughput = 0.0;
}

/// Pilot density of the paper's constant model.
pub const CONSTANT_PILOT: f64 = 0.3;
/// Iterations that the paper trains for: 2.5e5 steps in batches of 4096.
pub const PAPER_ITERATIONS: u64 = 62;

fn grid(fleets: &[u32], hotspots: &[u32]) -> Vec<(u32, u32)> {
    fleets
        .iter()
        .flat_map(|&n| hotspots.iter().map(move |&h| (n, h)))
        .collect()
}

impl Scale {
    /// The paper's whole grid.
    pub fn full(seeds: u64) -> Scale {
        let fleets = vec![5, 10, 15, 20];
        let hotspots = vec![3, 5, 7, 9, 11];
        Scale {
            name: "full",
            seeds: (0..seeds).collect(),
            episodes: 1000,
            tuned: Settings::preset(Preset::Tuned),
            paper: Settings::preset(Preset::Paper),
            paper_cells: grid(&fleets, &hotspots),
            variations: variations(),
            densities: vec![0.01, 0.05, 0.10, 0.15, 0.20, 0.25, 0.30],
            renewable_shares: vec![0.0, 0.1, 0.25, 0.5, 0.75, 1.0],
            fleets,
            hotspots,
        }
    }

    /// A smaller version of every part, for minutes instead of hours: half the numbers of hotspots,
    /// fewer missions, a shorter training, and the paper's own training for a few iterations only.
    pub fn quick(seeds: u64) -> Scale {
        let full = Scale::full(seeds);
        let hotspots = vec![3, 7, 11];
        let mut tuned = full.tuned.clone();
        tuned.total_steps = 30 * 96 * 32;
        tuned.environments = 96;
        tuned.workers = 12;
        tuned.batch_steps = 96 * 32;
        tuned.evaluation_episodes = 1;
        let paper = Settings {
            total_steps: 4 * 4096,
            evaluation_episodes: 10,
            ..full.paper.clone()
        };
        Scale {
            name: "quick",
            episodes: 40,
            paper_cells: grid(&[5], &hotspots),
            variations: Vec::new(),
            densities: vec![0.01, 0.10, 0.20, 0.30],
            renewable_shares: vec![0.0, 0.5, 1.0],
            tuned,
            paper,
            hotspots,
            ..full
        }
    }

    /// Only these fleets and numbers of hotspots, and of the latter only some with the paper's settings;
    /// empty: as they are.
    pub fn only(mut self, fleets: &[u32], hotspots: &[u32], paper_hotspots: &[u32]) -> Scale {
        let or = |given: &[u32], all: &[u32]| if given.is_empty() { all } else { given }.to_vec();
        self.fleets = or(fleets, &self.fleets);
        self.hotspots = or(hotspots, &self.hotspots);
        if self.name == "full" || !paper_hotspots.is_empty() {
            self.paper_cells = grid(&self.fleets, &or(paper_hotspots, &self.hotspots));
        }
        self
    }

    /// The mission of a cell in our preset.
    pub fn mission(&self, uavs: u32, hotspots: u32) -> Config {
        Config {
            uav_count: uavs,
            hotspot_count: hotspots,
            ..Config::default()
        }
    }

    /// The mission of a cell as the paper's equations have it.
    pub fn paper_mission(&self, uavs: u32, hotspots: u32) -> Config {
        let base = Config::preset(jcas_core::Preset::Paper);
        Config {
            uav_count: uavs,
            hotspot_count: hotspots,
            ..base
        }
    }

    /// The whole grid.
    pub fn cells(&self) -> Vec<(u32, u32)> {
        grid(&self.fleets, &self.hotspots)
    }

    /// Small batteries, where return to base and charging decide: about 25 moves to a charge.
    pub fn small_battery(&self, renewable_share: f64) -> Config {
        Config {
            battery_capacity_kwh: 0.03,
            rtb_threshold_kwh: 0.01,
            renewable_share,
            ..self.mission(10, 5)
        }
    }

    /// The cell on which variations are tried: N = 10, as near to n = 5 as was trained.
    pub fn variation_cell(&self) -> Option<(u32, u32)> {
        let cells = self.paper_cells.iter().copied();
        cells
            .filter(|&(uavs, _)| uavs == 10)
            .min_by_key(|&(_, hotspots)| hotspots.abs_diff(5))
    }

    /// The cell of the trade-off and of the approach: N = 10 with the most hotspots.
    pub fn hard_cell(&self) -> (u32, u32) {
        (10, self.hotspots.last().copied().unwrap_or(11))
    }
}
