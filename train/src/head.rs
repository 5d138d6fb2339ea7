//! Action heads: from the actor's outputs to a motion and a pilot density.
//!
//! Both heads give an action pair in [-1, 1]² that the kernel understands; what they keep in the
//! rollout buffer (`raw`) is the sample before that mapping, since its density is what PPO needs.

pub mod gaussian;
pub mod hybrid;

use burn_tensor::Tensor;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// Motions of the paper, in the order of their bins: up, down, left, right, stay.
pub const MOTIONS: usize = 5;

/// Motion index of a direction action: five equal bins over [-1, 1].
pub fn motion_of(u_dir: f32) -> usize {
    (((u_dir.clamp(-1.0, 1.0) + 1.0) / 2.0 * MOTIONS as f32) as usize).min(MOTIONS - 1)
}

/// Centre of a motion's bin, the direction action that stands for it.
pub fn motion_centre(motion: usize) -> f32 {
    -0.8 + 0.4 * motion as f32
}

/// Which distribution the actor's outputs describe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Head {
    /// The paper's: an independent normal for each of the two action components.
    Gaussian,
    /// A categorical motion and a Beta-distributed pilot density.
    Hybrid,
}

/// Log-densities and entropies of a batch of raw actions, one row each.
pub struct Densities {
    /// ln π(a|o) of motion and of pilot, which are independent given the observation (rows × 2).
    pub log_probs: Tensor<2>,
    /// Entropies of the two (rows × 2).
    pub entropies: Tensor<2>,
}

impl Head {
    /// Outputs that the actor must have.
    pub fn output_len(self) -> usize {
        match self {
            Head::Gaussian => gaussian::OUTPUT_LEN,
            Head::Hybrid => hybrid::OUTPUT_LEN,
        }
    }

    /// Draws a raw action; returns it with the log-densities of its motion and of its pilot. A hybrid's motion may
    /// be given as a quantile of its distribution, 0 to 1.
    pub fn sample(
        self,
        outputs: &[f32],
        quantile: Option<f64>,
        random: &mut ChaCha8Rng,
    ) -> ([f32; 2], [f32; 2]) {
        match self {
            Head::Gaussian => gaussian::sample(outputs, random),
            Head::Hybrid => {
                let quantile = quantile.unwrap_or_else(|| random.random());
                hybrid::sample(outputs, quantile, random)
            }
        }
    }

    /// The raw action that stands for the whole distribution: most likely motion, mean pilot.
    pub fn deterministic(self, outputs: &[f32]) -> [f32; 2] {
        match self {
            Head::Gaussian => gaussian::deterministic(outputs),
            Head::Hybrid => hybrid::deterministic(outputs),
        }
    }

    /// The kernel's action pair of a raw action.
    pub fn action(self, raw: [f32; 2]) -> [f32; 2] {
        match self {
            Head::Gaussian => raw.map(|u| u.clamp(-1.0, 1.0)),
            Head::Hybrid => [motion_centre(raw[0] as usize), 2.0 * raw[1] - 1.0],
        }
    }

    /// Log-densities of `raw` (rows × 2) under `outputs` (rows × output_len), differentiable.
    pub fn densities(self, outputs: Tensor<2>, raw: &[f32]) -> Densities {
        match self {
            Head::Gaussian => gaussian::densities(outputs, raw),
            Head::Hybrid => hybrid::densities(outputs, raw),
        }
    }

    /// As [`Self::densities`], of the motion alone (rows × 1 each).
    pub fn motion_densities(self, outputs: Tensor<2>, raw: &[f32]) -> Densities {
        match self {
            Head::Gaussian => gaussian::motion_densities(outputs, raw),
            Head::Hybrid => hybrid::motion_densities(&outputs, raw),
        }
    }
}
