//! Action heads: from the actor's outputs to a motion and a pilot density.
//!
//! Both heads give an action pair in [-1, 1]², which the kernel reads. The rollout buffer holds the
//! sample before that mapping (`raw`), because PPO needs the sample's density.

pub mod gaussian;
pub mod hybrid;

use burn_tensor::Tensor;
use jcas_core::action::motion;
use jcas_core::{Motion, MotionMap};
use jcas_policy::head::Head;
use rand_chacha::ChaCha8Rng;

/// Log-densities and entropies of a batch of raw actions, one row each.
pub struct Densities {
    /// ln π(a|o) of motion and of pilot, which are independent given the observation (rows × 2).
    pub log_probs: Tensor<2>,
    /// Entropies of the two (rows × 2).
    pub entropies: Tensor<2>,
}

/// Operations of an action head that only training needs.
pub trait LearningHead {
    /// Draws a raw action; returns it with the log-densities of its motion and of its pilot.
    fn draw(self, outputs: &[f32], random: &mut ChaCha8Rng) -> ([f32; 2], [f32; 2]);

    /// The raw action of the most likely motion and the mean pilot.
    fn most_likely(self, outputs: &[f32], map: MotionMap) -> [f32; 2];

    /// The kernel's action pair of a raw action.
    fn action(self, raw: [f32; 2], map: MotionMap) -> [f32; 2];

    /// Log-densities of `raw` (rows × 2) under `outputs` (rows × [`Head::outputs`]),
    /// differentiable.
    fn densities(self, outputs: Tensor<2>, raw: &[f32]) -> Densities;

    /// As [`Self::densities`], of the motion alone (rows × 1 each).
    fn motion_densities(self, outputs: Tensor<2>, raw: &[f32]) -> Densities;
}

impl LearningHead for Head {
    fn draw(self, outputs: &[f32], random: &mut ChaCha8Rng) -> ([f32; 2], [f32; 2]) {
        match self {
            Head::Gaussian => gaussian::sample(outputs, random),
            Head::Hybrid => hybrid::sample(outputs, random),
        }
    }

    fn most_likely(self, outputs: &[f32], map: MotionMap) -> [f32; 2] {
        let [direction, pilot] = self.deterministic(outputs, map);
        match self {
            Head::Gaussian => [direction, pilot],
            Head::Hybrid => [motion(direction, map) as u8 as f32, 0.5 * (pilot + 1.0)],
        }
    }

    fn action(self, raw: [f32; 2], map: MotionMap) -> [f32; 2] {
        match self {
            Head::Gaussian => raw.map(|u| u.clamp(-1.0, 1.0)),
            Head::Hybrid => [
                Motion::ALL[raw[0] as usize].to_action(map),
                2.0 * raw[1] - 1.0,
            ],
        }
    }

    fn densities(self, outputs: Tensor<2>, raw: &[f32]) -> Densities {
        match self {
            Head::Gaussian => gaussian::densities(outputs, raw),
            Head::Hybrid => hybrid::densities(outputs, raw),
        }
    }

    fn motion_densities(self, outputs: Tensor<2>, raw: &[f32]) -> Densities {
        match self {
            Head::Gaussian => gaussian::motion_densities(outputs, raw),
            Head::Hybrid => hybrid::motion_densities(&outputs, raw),
        }
    }
}
