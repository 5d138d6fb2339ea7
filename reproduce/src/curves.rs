//! How the trainings with the paper's settings went, from the metrics that each run keeps.

use crate::flights::{POLICIES, paper_name};
use crate::plan::{PAPER_ITERATIONS, Scale};
use jcas_train::error::TrainError;
use jcas_train::policy::files::CARD;
use jcas_train::run::METRICS;
use std::path::Path;

/// Training of one cell with the paper's settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Who learnt: see [`Scale::learners`].
    pub learner: &'static str,
    /// UAVs.
    pub uavs: u32,
    /// Hotspots.
    pub hotspots: u32,
    /// Training seed.
    pub seed: u64,
    /// Mean return of the missions that ended in each iteration (NaN where none did).
    pub returns: Vec<f64>,
    /// Wall time of the training.
    pub training_s: f64,
}

impl Curve {
    /// Wall time of the paper's number of iterations at this run's pace.
    pub fn whole_training_s(&self) -> f64 {
        self.training_s * PAPER_ITERATIONS as f64 / self.returns.len().max(1) as f64
    }
}

/// The training curves of the adaptive runs in the preset `paper`, as far as they are trained.
pub fn curves(scale: &Scale, out: &Path) -> Result<Vec<Curve>, TrainError> {
    let mut curves = Vec::new();
    for learner in scale.learners() {
        for &(uavs, hotspots) in &scale.paper_cells {
            for &seed in &scale.seeds {
                let name = paper_name(learner.name, (uavs, hotspots), None, seed);
                let folder = out.join(POLICIES).join(name);
                if !folder.join(CARD).exists() {
                    continue;
                }
                let (returns, wall_s) = iterations(&folder.join(METRICS))?;
                curves.push(Curve {
                    learner: learner.name,
                    uavs,
                    hotspots,
                    seed,
                    returns,
                    training_s: wall_s.iter().sum(),
                });
            }
        }
    }
    Ok(curves)
}

/// Mean return and wall time of each iteration. A run that was stopped and continued has them all here.
fn iterations(path: &Path) -> Result<(Vec<f64>, Vec<f64>), TrainError> {
    #[derive(serde::Deserialize)]
    struct Line {
        return_mean: Option<f64>,
        wall_s: f64,
    }
    let mut reader = csv::Reader::from_path(path).map_err(TrainError::format(path))?;
    let lines = reader.deserialize::<Line>().map(|line| {
        let line = line.map_err(TrainError::format(path))?;
        Ok((line.return_mean.unwrap_or(f64::NAN), line.wall_s))
    });
    lines.collect()
}
