//! The course of the trainings with the paper's settings. It is a table beside the results, so that
//! pages depend only on tables.

use crate::campaign::{ADAPTIVE, pilot_name};
use crate::flights::{POLICIES, paper_name};
use crate::scope::{CONSTANT_PILOT, PAPER_ITERATIONS, Scope, Training};
use jcas_episode::card::CARD;
use jcas_train::error::TrainError;
use jcas_train::run::METRICS;
use jcas_train::store::{csv_bytes, write_whole};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name of the table of trainings.
pub const TRAININGS: &str = "trainings.csv";

/// Training of one cell with the paper's settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name of the learner, see [`Scope::learners`].
    pub learner: &'static str,
    /// UAVs.
    pub uavs: u32,
    /// Hotspots.
    pub hotspots: u32,
    /// The pilot density that was held; absent: it was learnt.
    pub constant: Option<f64>,
    /// Training seed.
    pub seed: u64,
    /// Mean return of the missions that ended in each iteration (NaN where none did).
    pub returns: Vec<f64>,
    /// Wall time of an iteration, the median: what else the machine did meanwhile counts little.
    pub iteration_s: f64,
}

impl Curve {
    /// Wall time of the paper's number of iterations at this run's pace.
    pub fn whole_training_s(&self) -> f64 {
        self.iteration_s * PAPER_ITERATIONS as f64
    }
}

/// One iteration of one training, as the table has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Line {
    learner: String,
    uavs: u32,
    hotspots: u32,
    pilot: String,
    seed: u64,
    iteration: u64,
    return_mean: Option<f64>,
    success_rate: Option<f64>,
    mission_steps_mean: Option<f64>,
    wall_s: f64,
}

impl Line {
    fn is_of(&self, learner: &str, pilot: &str, training: &Training) -> bool {
        let cell = (self.uavs, self.hotspots);
        (self.learner.as_str(), self.pilot.as_str()) == (learner, pilot)
            && (cell, self.seed) == (training.cell, training.seed)
    }
}

/// What a run keeps of an iteration.
#[derive(Deserialize)]
struct Metrics {
    iteration: u64,
    return_mean: Option<f64>,
    success_rate: Option<f64>,
    mission_steps_mean: Option<f64>,
    wall_s: f64,
}

/// Takes the metrics of the trainings in the folder into its table, in place of what the table had
/// of them. A run that was stopped and continued has all its iterations there.
pub(crate) fn gather(scope: &Scope, out: &Path) -> Result<(), TrainError> {
    let path = out.join(TRAININGS);
    let mut lines = table(&path)?;
    let before = lines.clone();
    for learner in scope.learners() {
        for training in scope.trainings() {
            let (cell, seed) = (training.cell, training.seed);
            let name = paper_name(learner.name, cell, training.constant, seed);
            let folder = out.join(POLICIES).join(name);
            if !folder.join(CARD).exists() {
                continue;
            }
            let pilot = pilot_name(training.constant);
            lines.retain(|line| !line.is_of(learner.name, pilot, &training));
            let metrics: Vec<Metrics> = rows(&folder.join(METRICS))?;
            lines.extend(metrics.into_iter().map(|metrics| Line {
                learner: learner.name.to_owned(),
                uavs: cell.0,
                hotspots: cell.1,
                pilot: pilot.to_owned(),
                seed,
                iteration: metrics.iteration,
                return_mean: metrics.return_mean,
                success_rate: metrics.success_rate,
                mission_steps_mean: metrics.mission_steps_mean,
                wall_s: metrics.wall_s,
            }));
        }
    }
    if lines == before {
        return Ok(());
    }
    write_whole(&path, &csv_bytes(&lines, true, &path)?)
}

/// The training curves in the preset `paper` that the folder's table has, with every seed.
pub fn curves(scope: &Scope, out: &Path) -> Result<Vec<Curve>, TrainError> {
    let lines = table(&out.join(TRAININGS))?;
    let mut trainings: Vec<(u64, (u32, u32), &str)> = Vec::new();
    for line in &lines {
        let training = (line.seed, (line.uavs, line.hotspots), line.pilot.as_str());
        if !trainings.contains(&training) {
            trainings.push(training);
        }
    }
    trainings.sort_unstable();
    let mut curves = Vec::new();
    for learner in scope.learners() {
        for &(seed, cell, pilot) in &trainings {
            let training = Training {
                cell,
                constant: (pilot != ADAPTIVE).then_some(CONSTANT_PILOT),
                seed,
            };
            let of = |line: &&Line| line.is_of(learner.name, pilot, &training);
            let lines: Vec<&Line> = lines.iter().filter(of).collect();
            if lines.is_empty() {
                continue;
            }
            let mut wall_s: Vec<f64> = lines.iter().map(|line| line.wall_s).collect();
            wall_s.sort_by(f64::total_cmp);
            let returns = lines.iter().map(|line| line.return_mean);
            curves.push(Curve {
                learner: learner.name,
                uavs: training.cell.0,
                hotspots: training.cell.1,
                constant: training.constant,
                seed: training.seed,
                returns: returns.map(|mean| mean.unwrap_or(f64::NAN)).collect(),
                iteration_s: wall_s[wall_s.len() / 2],
            });
        }
    }
    Ok(curves)
}

fn table(path: &Path) -> Result<Vec<Line>, TrainError> {
    if path.exists() {
        rows(path)
    } else {
        Ok(Vec::new())
    }
}

fn rows<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, TrainError> {
    let mut reader = csv::Reader::from_path(path).map_err(TrainError::format(path))?;
    let rows = reader.deserialize();
    rows.map(|row| row.map_err(TrainError::format(path)))
        .collect()
}
