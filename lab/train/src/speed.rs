//! How fast a run was, and how much of the machine's arithmetic it used.

use crate::metrics::Row;
use rayon::prelude::*;
use serde::Serialize;
use std::time::Instant;

/// Side of the square matrices of the reference product.
const SIDE: usize = 1024;

/// Rate of plain large f32 matrix products on all threads of the current pool, GFLOP/s: the best
/// of a few, so that a busy moment does not lower the bar.
pub fn plain_product_gflops() -> f64 {
    use burn_tensor::Device;
    let device = Device::flex();
    let threads = rayon::current_num_threads();
    let matrices: Vec<_> = (0..threads)
        .map(|_| crate::network::matrix(vec![0.5; SIDE * SIDE], SIDE, &device))
        .collect();
    let mut best = 0.0f64;
    for _ in 0..3 {
        let started = Instant::now();
        let sums: Vec<f32> = matrices
            .par_iter()
            .map(|matrix| {
                let product = matrix.clone().matmul(matrix.clone());
                crate::network::values(product)[SIDE]
            })
            .collect();
        assert_eq!(sums[0], 0.25 * SIDE as f32);
        let operations = threads as f64 * 2.0 * (SIDE as f64).powi(3);
        best = best.max(operations / started.elapsed().as_secs_f64() / 1e9);
    }
    best
}

/// Totals of a run, on this machine.
#[derive(Clone, Debug, Serialize)]
pub struct Speed {
    /// Plain large f32 matrix products at the start of this run.
    pub plain_product_gflops: f64,
    /// Matrix products in the learning phase.
    pub learning_gflops: f64,
    /// The latter over the former.
    pub learning_share_of_plain: f64,
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
    /// Nothing timed yet.
    pub fn new(plain_product_gflops: f64) -> Speed {
        Speed {
            plain_product_gflops,
            learning_gflops: 0.0,
            learning_share_of_plain: 0.0,
            iterations: 0,
            training_s: 0.0,
            evaluation_s: 0.0,
            steps_per_s: 0.0,
            samples_per_s: 0.0,
            simulation_share: 0.0,
            inference_share: 0.0,
            learning_share: 0.0,
        }
    }

    /// Takes an iteration into the time-weighted means.
    pub fn add(&mut self, row: &Row) {
        let learning_before = self.learning_share * self.training_s;
        let learning = row.learning_share * row.wall_s;
        let blend = |old: f64, old_weight: f64, new: f64, weight: f64| {
            if old_weight + weight > 0.0 {
                (old * old_weight + new * weight) / (old_weight + weight)
            } else {
                0.0
            }
        };
        self.learning_gflops = blend(
            self.learning_gflops,
            learning_before,
            row.learning_gflops,
            learning,
        );
        let (before, wall) = (self.training_s, row.wall_s);
        self.steps_per_s = blend(self.steps_per_s, before, row.steps_per_s, wall);
        self.samples_per_s = blend(self.samples_per_s, before, row.samples_per_s, wall);
        self.simulation_share = blend(self.simulation_share, before, row.simulation_share, wall);
        self.inference_share = blend(self.inference_share, before, row.inference_share, wall);
        self.learning_share = blend(self.learning_share, before, row.learning_share, wall);
        self.learning_share_of_plain = self.learning_gflops / self.plain_product_gflops.max(1e-9);
        self.iterations += 1;
        self.training_s += wall;
    }

    /// Mean wall time of an iteration.
    pub fn seconds_per_iteration(&self) -> f64 {
        self.training_s / self.iterations.max(1) as f64
    }
}
