//! Scope of a reproduction: the parts of the paper's grid to train and evaluate.

use crate::fit;
use crate::text::list;
use crate::variation::{Variation, uav_credit, variations};
use jcas_core::{Config, Preset};
use jcas_train::settings::{Credit, Preset as TrainingPreset, Settings};
use std::path::PathBuf;

#[cfg(test)]
mod tests;

/// Size of a reproduction.
#[derive(Clone, Debug)]
pub struct Scope {
    /// Name in reports: `full` or `quick`.
    pub name: &'static str,
    /// Presets in which the grid is flown and our settings are trained.
    pub presets: Vec<Preset>,
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
    /// Pilot densities that are held there; None: the density is learnt.
    pub paper_pilots: Vec<Option<f64>>,
    /// Train only this credit scheme; None trains all. Existing results of the others are still
    /// reported.
    pub paper_credit: Option<Credit>,
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
    /// Pilot densities of the study of adaptive pilots: fine for single presets, coarse for maps of
    /// regimes, which are left out without any.
    pub pilot_densities: (Vec<f64>, Vec<f64>),
    /// Whether those maps are flown whole, or at their corners only.
    pub whole_maps: bool,
    /// Fleets that fly until their batteries decide.
    pub endurance_fleets: Vec<u32>,
    /// Folders of trained policies from elsewhere; each is ours in the mission that it was trained
    /// on, and none is trained there.
    pub given: Vec<PathBuf>,
    /// What is to be done; what is not is left as it is.
    pub parts: Vec<Part>,
}

/// A training with the paper's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Training {
    /// N, n.
    pub cell: (u32, u32),
    /// The pilot density that is held; absent: it is learnt.
    pub constant: Option<f64>,
    /// Of the training.
    pub seed: u64,
}

/// A part of a reproduction that can be done by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Scripted policies over the grid, in both presets.
    Baselines,
    /// Success of scripts over the sensing range, and which range fits the paper's numbers.
    SensingRange,
    /// The same for the paper's training.
    TrainedRanges,
    /// The paper's training in each cell of the preset `paper`.
    Paper,
    /// One policy for the whole grid, with our settings, in both presets.
    Tuned,
    /// The paper's training with one thing changed at a time.
    Variations,
    /// Scripts, plans and our policies in every cell, also where hotspots are hidden.
    Comparison,
    /// What adapting the pilot density is worth, and where.
    Pilot,
    /// Missions that outlast many batteries.
    Endurance,
}

impl Part {
    /// All of them, in the order in which they are done.
    pub const ALL: [Part; 9] = [
        Part::Baselines,
        Part::SensingRange,
        Part::Pilot,
        Part::Endurance,
        Part::Tuned,
        Part::Comparison,
        Part::Paper,
        Part::TrainedRanges,
        Part::Variations,
    ];
}

/// A learner with the paper's settings.
#[derive(Clone, Debug)]
pub struct Learner {
    /// Name in the table and in folders.
    pub name: &'static str,
    /// For people.
    pub title: &'static str,
    /// How it is trained.
    pub settings: Settings,
}

impl Learner {
    /// Title in reports, which says so if the training was shorter than the paper's.
    pub fn as_trained(&self) -> String {
        let iterations = self.settings.iterations();
        let whole = Settings::preset(TrainingPreset::Paper).iterations();
        if iterations < whole {
            format!("{} ({iterations} of {whole} iterations)", self.title)
        } else {
            self.title.to_owned()
        }
    }
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

impl Scope {
    /// The paper's whole grid.
    pub fn full(seeds: u64) -> Scope {
        let fleets = vec![5, 10, 15, 20];
        let hotspots = vec![3, 5, 7, 9, 11];
        Scope {
            name: "full",
            presets: vec![Preset::Paper, Preset::Mission],
            seeds: (0..seeds).collect(),
            episodes: 1000,
            tuned: Settings::preset(TrainingPreset::Tuned),
            paper: Settings::preset(TrainingPreset::Paper),
            paper_cells: grid(&fleets, &hotspots),
            paper_pilots: vec![None, Some(CONSTANT_PILOT)],
            paper_credit: None,
            variations: variations(),
            densities: vec![0.01, 0.05, 0.10, 0.15, 0.20, 0.25, 0.30],
            renewable_shares: vec![0.0, 0.1, 0.25, 0.5, 0.75, 1.0],
            ranges: vec![
                0.5, 1.0, 1.5, 2.0, 2.25, 2.5, 2.75, 3.0, 3.25, 3.5, 4.0, 4.5, 5.0,
            ],
            trained_ranges: (vec![2.0, 3.0, 4.0, 5.0], vec![(10, 5), (15, 5)]),
            pilot_densities: (
                vec![0.01, 0.02, 0.05, 0.10, 0.15, 0.20, 0.25, 0.30],
                vec![0.01, 0.05, 0.10, 0.20, 0.30],
            ),
            whole_maps: true,
            endurance_fleets: vec![5, 6, 8, 10],
            given: Vec::new(),
            parts: Part::ALL.to_vec(),
            fleets,
            hotspots,
        }
    }

    /// A smaller version of every part, for minutes instead of hours. It has half the numbers of
    /// hotspots, fewer episodes and a shorter training. The paper's training is short, with small
    /// networks, one number of hotspots and a learnt pilot density.
    pub fn quick(seeds: u64) -> Scope {
        let full = Scope::full(seeds);
        let hotspots = vec![3, 7, 11];
        let mut tuned = full.tuned.clone();
        tuned.total_steps = 30 * 96 * 32;
        tuned.environments = 96;
        tuned.workers = 12;
        tuned.batch_steps = 96 * 32;
        tuned.evaluation_episodes = 1;
        let paper = Settings {
            actor_hidden: vec![128, 64],
            critic_hidden: vec![128, 64],
            minibatch_rows: 1024,
            total_steps: 7 * 4096,
            evaluation_episodes: 10,
            ..full.paper.clone()
        };
        Scope {
            name: "quick",
            presets: vec![Preset::Paper],
            episodes: 40,
            paper_cells: grid(&full.fleets, &[7]),
            paper_pilots: vec![None],
            variations: Vec::new(),
            densities: vec![0.01, 0.10, 0.20, 0.30],
            renewable_shares: vec![0.0, 0.5, 1.0],
            ranges: vec![1.0, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0],
            trained_ranges: (Vec::new(), Vec::new()),
            pilot_densities: (vec![0.01, 0.10, 0.20, 0.30], vec![0.01, 0.30]),
            whole_maps: false,
            endurance_fleets: vec![6, 10],
            tuned,
            paper,
            hotspots,
            ..full
        }
    }

    /// Only these fleets and numbers of hotspots, and of the latter only some with the paper's
    /// settings; empty: as they are.
    pub fn only(mut self, fleets: &[u32], hotspots: &[u32], paper_hotspots: &[u32]) -> Scope {
        let or = |given: &[u32], all: &[u32]| if given.is_empty() { all } else { given }.to_vec();
        self.fleets = or(fleets, &self.fleets);
        self.hotspots = or(hotspots, &self.hotspots);
        if self.name == "full" || !paper_hotspots.is_empty() {
            self.paper_cells = grid(&self.fleets, &or(paper_hotspots, &self.hotspots));
        }
        let fleets = &self.fleets;
        self.paper_cells.retain(|(uavs, _)| fleets.contains(uavs));
        self
    }

    /// How much of the paper's training its learners are given; none where it is all.
    pub fn shortened(&self) -> Option<String> {
        let whole = Settings::preset(TrainingPreset::Paper);
        (self.paper != whole).then(|| {
            format!(
                "{} of the paper's {} iterations, hidden layers of {:?} in place of {:?}",
                self.paper.iterations(),
                whole.iterations(),
                self.paper.actor_hidden,
                whole.actor_hidden
            )
        })
    }

    /// Which numbers of hotspots a mean is over; nothing where it is over all of them.
    pub fn over(&self, hotspots: &[u32]) -> String {
        if hotspots == self.hotspots {
            String::new()
        } else {
            format!(" (n = {})", list(hotspots))
        }
    }

    /// Only these parts.
    #[must_use]
    pub fn parts(self, parts: Vec<Part>) -> Scope {
        Scope { parts, ..self }
    }

    /// With these trained policies from elsewhere.
    #[must_use]
    pub fn with(self, given: Vec<PathBuf>) -> Scope {
        Scope { given, ..self }
    }

    /// Learners with the paper's settings: its text on credit allows two readings.
    pub fn learners(&self) -> Vec<Learner> {
        let mut own = self.paper.clone();
        uav_credit(&mut own);
        vec![
            Learner {
                name: "ppo",
                title: "the paper's PPO, credit of the team",
                settings: self.paper.clone(),
            },
            Learner {
                name: "ppo-uav",
                title: "the paper's PPO, credit of each UAV",
                settings: own,
            },
        ]
    }

    /// Those of them that are to be trained.
    pub fn trained(&self) -> Vec<Learner> {
        let mut learners = self.learners();
        learners.retain(|learner| {
            self.paper_credit
                .is_none_or(|credit| learner.settings.credit == credit)
        });
        learners
    }

    /// The trainings of each learner, the most informative first, so that a stopped reproduction is
    /// useful. The order is: numbers of hotspots near the paper's five, adaptive pilots, fleets
    /// with a success rate in the paper.
    pub fn trainings(&self) -> Vec<Training> {
        let mut trainings = Vec::new();
        for &seed in &self.seeds {
            for &cell in &self.paper_cells {
                for &constant in &self.paper_pilots {
                    trainings.push(Training {
                        cell,
                        constant,
                        seed,
                    });
                }
            }
        }
        trainings.sort_by_key(|training| {
            let (uavs, hotspots) = training.cell;
            let published = fit::PAPER.iter().any(|paper| paper.uavs == uavs);
            (
                training.seed,
                hotspots.abs_diff(5),
                training.constant.is_some(),
                !published,
            )
        });
        trainings
    }

    /// The mission of a cell in a preset.
    pub fn mission(&self, preset: Preset, (uavs, hotspots): (u32, u32)) -> Config {
        Config {
            uav_count: uavs,
            hotspot_count: hotspots,
            ..Config::preset(preset)
        }
    }

    /// The mission of a cell in the preset `paper` with another sensing range.
    pub fn ranged(&self, cells: f64, cell: (u32, u32)) -> Config {
        let base = self.mission(Preset::Paper, cell);
        Config {
            sensing_range_m: Some(cells * base.cell_size_m),
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
            ..self.mission(Preset::Mission, (10, 5))
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
