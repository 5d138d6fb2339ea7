//! How much of the paper's grid is trained and flown.

use jcas_core::{Config, InformPayment, Preset as World, radar};
use jcas_train::head::Head;
use jcas_train::settings::{Preset, Settings};

/// Size of a reproduction.
#[derive(Clone, Debug)]
pub struct Scale {
    /// Name in reports: `full` or `quick`.
    pub name: &'static str,
    /// Presets in which the grid is flown and our settings are trained.
    pub presets: Vec<World>,
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
    /// Sensing ranges of the study of what the paper's numbers imply, in cells, rising.
    pub ranges: Vec<f64>,
    /// Those of them at which the paper's training is tried as well, for these cells (N, n).
    pub trained_ranges: (Vec<f64>, Vec<(u32, u32)>),
    /// What is to be done; what is not is left as it is.
    pub parts: Vec<Part>,
}

/// A part of a reproduction that can be done by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Scripted policies over the grid, in both presets.
    Baselines,
    /// Success over the sensing range, and which range fits the paper's numbers.
    SensingRange,
    /// The paper's training in each cell of the preset `paper`.
    Paper,
    /// One policy for the whole grid, with our settings, in both presets.
    Tuned,
    /// The paper's training with one thing changed at a time.
    Variations,
}

impl Part {
    /// All of them, in the order in which they are done.
    pub const ALL: [Part; 5] = [
        Part::Baselines,
        Part::SensingRange,
        Part::Paper,
        Part::Tuned,
        Part::Variations,
    ];
}

/// Who trains with the paper's settings.
#[derive(Clone, Debug)]
pub struct Learner {
    /// Name in the table and in folders.
    pub name: &'static str,
    /// For people.
    pub title: &'static str,
    /// How it is trained.
    pub settings: Settings,
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
            presets: vec![World::Paper, World::Mission],
            seeds: (0..seeds).collect(),
            episodes: 1000,
            tuned: Settings::preset(Preset::Tuned),
            paper: Settings::preset(Preset::Paper),
            paper_cells: grid(&fleets, &hotspots),
            variations: variations(),
            densities: vec![0.01, 0.05, 0.10, 0.15, 0.20, 0.25, 0.30],
            renewable_shares: vec![0.0, 0.1, 0.25, 0.5, 0.75, 1.0],
            ranges: vec![
                0.5, 1.0, 1.5, 2.0, 2.25, 2.5, 2.75, 3.0, 3.25, 3.5, 4.0, 4.5, 5.0,
            ],
            trained_ranges: (vec![2.0, 2.5, 3.0, 3.5, 4.0], vec![(10, 5), (15, 5)]),
            parts: Part::ALL.to_vec(),
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
            presets: vec![World::Paper],
            episodes: 40,
            paper_cells: grid(&[5], &hotspots),
            variations: Vec::new(),
            densities: vec![0.01, 0.10, 0.20, 0.30],
            renewable_shares: vec![0.0, 0.5, 1.0],
            ranges: vec![1.0, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0],
            trained_ranges: (Vec::new(), Vec::new()),
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

    /// Only these parts.
    #[must_use]
    pub fn parts(self, parts: Vec<Part>) -> Scale {
        Scale { parts, ..self }
    }

    /// Who trains with the paper's settings.
    pub fn learners(&self) -> Vec<Learner> {
        vec![Learner {
            name: "ppo",
            title: "the paper's PPO",
            settings: self.paper.clone(),
        }]
    }

    /// The mission of a cell in a preset.
    pub fn mission(&self, preset: World, (uavs, hotspots): (u32, u32)) -> Config {
        Config {
            uav_count: uavs,
            hotspot_count: hotspots,
            ..Config::preset(preset)
        }
    }

    /// The mission of a cell in the preset `paper` with another sensing range.
    pub fn ranged(&self, cells: f64, cell: (u32, u32)) -> Config {
        let base = self.mission(World::Paper, cell);
        let range_m = cells * base.cell_size_m;
        Config {
            detection_threshold_db: Some(radar::snr_db(&base, range_m)),
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
            ..self.mission(World::Mission, (10, 5))
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
