//! How fast a run was, and what its time went into.

use crate::metrics::Row;
use serde::Serialize;

/// Totals of a run, on this machine.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Speed {
    /// Iterations timed.
    pub iterations: u64,
    /// Wall time of training.
    pub training_s: f64,
    /// Wall time of the evaluation at the end.
    pub evaluation_s: f64,
    /// Environment steps in each second.
    pub steps_per_s: f64,
    /// UAV samples in each second.
    pub samples_per_s: f64,
    /// Shares of wall time.
    pub simulation_share: f64,
    /// In the actor while collecting.
    pub inference_share: f64,
    /// Learning.
    pub learning_share: f64,
}

impl Speed {
    /// Takes an iteration into the time-weighted means.
    pub fn add(&mut self, row: &Row) {
        let blend = |old: f64, old_weight: f64, new: f64, weight: f64| {
            if old_weight + weight > 0.0 {
                (old * old_weight + new * weight) / (old_weight + weight)
            } else {
                0.0
            }
        };
        let (before, wall) = (self.training_s, row.wall_s);
        self.steps_per_s = blend(self.steps_per_s, before, row.steps_per_s, wall);
        self.samples_per_s = blend(self.samples_per_s, before, row.samples_per_s, wall);
        self.simulation_share = blend(self.simulation_share, before, row.simulation_share, wall);
        self.inference_share = blend(self.inference_share, before, row.inference_share, wall);
        self.learning_share = blend(self.learning_share, before, row.learning_share, wall);
        self.iterations += 1;
        self.training_s += wall;
    }

    /// Mean wall time of an iteration.
    pub fn seconds_per_iteration(&self) -> f64 {
        self.training_s / self.iterations.max(1) as f64
    }
}
