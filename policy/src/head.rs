//! Action heads: from a network's outputs to a motion and a pilot density.
//!
//! Draws come from the kernel's generator under the purpose for policies. They are a function of
//! the episode's seed, the step and the UAV. Block 0 holds the motion's draw (or the normals), and
//! the other blocks the pilot density's.

mod beta;

use jcas_core::rng::{self, Purpose};
use jcas_core::{Motion, MotionMap};

/// The number of motions. In the order of their logits they are up, down, left, right, stay.
pub const MOTIONS: usize = Motion::ALL.len();

/// Bounds of a normal's log standard deviation.
const LOG_STD: [f32; 2] = [-2.3, 1.0];

/// An action head: the distribution that the outputs of a network describe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Head {
    /// An independent normal for each of the two action components. Outputs: two means, two log
    /// standard deviations.
    Gaussian,
    /// A categorical motion and a Beta-distributed pilot density. Outputs: five logits, then x for
    /// each of α, β = 1 + softplus(x).
    Hybrid,
}

/// An acting mode: how actions follow from the distribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Mode {
    /// The most likely motion and the mean pilot density. UAVs that choose sequentially stay on a
    /// depot to charge. They sample where they would turn back without a new confirmation.
    Deterministic,
    /// A draw that is a function of the seed of the episode.
    Sampled,
}

impl Mode {
    /// All modes, in ascending order of randomness.
    pub const ALL: [Self; 2] = [Self::Deterministic, Self::Sampled];

    /// The name of the mode in files and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Deterministic => "deterministic",
            Self::Sampled => "sampled",
        }
    }

    /// The mode of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| mode.name() == name)
    }
}

/// The key of a draw: the draw is a function of these fields alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Draw {
    /// Seed of the episode.
    pub seed: u64,
    /// Step.
    pub t: u32,
    /// Index of the UAV.
    pub uav: u32,
}

impl Draw {
    fn block(self, index: u32) -> [u32; 4] {
        rng::block(self.seed, self.t, self.uav, index, Purpose::Policy)
    }

    /// The uniform number of the motion, in [0, 1).
    pub(crate) fn unit(self) -> f64 {
        let block = self.block(0);
        rng::unit(u64::from(block[0]) | u64::from(block[1]) << 32)
    }
}

fn between(value: f32, low: f32, high: f32) -> f32 {
    if value > high {
        high
    } else if value > low {
        value
    } else {
        low
    }
}

/// Returns a number in (0, 1]. It excludes zero, whose logarithm is infinite.
fn unit_above_zero(low: u32, high: u32) -> f64 {
    1.0 - rng::unit(u64::from(low) | u64::from(high) << 32)
}

/// Returns two independent standard normals (G. E. P. Box and M. E. Muller, 1958).
fn normals(block: [u32; 4]) -> [f64; 2] {
    let radius = libm::sqrt(-2.0 * libm::log(unit_above_zero(block[0], block[1])));
    let angle = core::f64::consts::TAU * rng::unit(u64::from(block[2]) | u64::from(block[3]) << 32);
    [radius * libm::cos(angle), radius * libm::sin(angle)]
}

/// ln(1 + eˣ).
fn softplus(x: f32) -> f64 {
    let x = f64::from(x);
    let above = if x > 0.0 { x } else { 0.0 };
    above + libm::log1p(libm::exp(-x.abs()))
}

impl Head {
    pub(crate) const fn of_outputs(outputs: usize) -> Option<Self> {
        match outputs {
            4 => Some(Self::Gaussian),
            7 => Some(Self::Hybrid),
            _ => None,
        }
    }

    /// The number of outputs of a network with this head.
    #[must_use]
    pub const fn outputs(self) -> usize {
        match self {
            Self::Gaussian => 4,
            Self::Hybrid => 7,
        }
    }

    /// The action (u_dir, u_pilot) of the deterministic mode: the most likely motion and the mean
    /// pilot density. `outputs` holds [`Head::outputs`] numbers.
    ///
    /// A categorical head chooses the centre of its motion's bin. The means of a normal are the
    /// action itself, so their motions depend on the map.
    #[must_use]
    pub fn deterministic(self, outputs: &[f32], map: MotionMap) -> [f32; 2] {
        match self {
            Self::Gaussian => [
                between(outputs[0], -1.0, 1.0),
                between(outputs[1], -1.0, 1.0),
            ],
            Self::Hybrid => {
                let mut motion = 0;
                for candidate in 1..MOTIONS {
                    if outputs[candidate] > outputs[motion] {
                        motion = candidate;
                    }
                }
                [Motion::ALL[motion].to_action(map), mean_pilot(outputs)]
            }
        }
    }

    /// A drawn action (u_dir, u_pilot).
    pub(crate) fn sample(self, outputs: &[f32], map: MotionMap, draw: Draw) -> [f32; 2] {
        match self {
            Self::Gaussian => {
                let normals = normals(draw.block(0));
                let component = |axis: usize| {
                    let log_std = between(outputs[2 + axis], LOG_STD[0], LOG_STD[1]);
                    let spread = libm::exp(f64::from(log_std)) * normals[axis];
                    between((f64::from(outputs[axis]) + spread) as f32, -1.0, 1.0)
                };
                [component(0), component(1)]
            }
            Self::Hybrid => {
                let (alpha, beta) = concentrations(outputs);
                let pilot = beta::sample(alpha, beta, draw) as f32;
                let motion = Motion::ALL[motion_at(outputs, draw.unit())];
                [motion.to_action(map), 2.0 * pilot - 1.0]
            }
        }
    }
}

fn concentrations(outputs: &[f32]) -> (f64, f64) {
    (
        1.0 + softplus(outputs[MOTIONS]),
        1.0 + softplus(outputs[MOTIONS + 1]),
    )
}

/// The mean of the Beta distribution, as an action.
fn mean_pilot(outputs: &[f32]) -> f32 {
    let (alpha, beta) = concentrations(outputs);
    2.0 * (alpha / (alpha + beta)) as f32 - 1.0
}

/// The motion at a quantile of the categorical distribution.
fn motion_at(logits: &[f32], quantile: f64) -> usize {
    let mut max = logits[0];
    for &logit in &logits[1..MOTIONS] {
        max = if logit > max { logit } else { max };
    }
    let weight = |motion: usize| libm::exp(f64::from(logits[motion] - max));
    let mut total = 0.0;
    for motion in 0..MOTIONS {
        total += weight(motion);
    }
    let mut left = total * quantile;
    for motion in 0..MOTIONS - 1 {
        left -= weight(motion);
        if left < 0.0 {
            return motion;
        }
    }
    MOTIONS - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRAWS: u32 = 40_000;

    fn draws(head: Head, outputs: &[f32]) -> impl Iterator<Item = [f32; 2]> {
        let draw = |t: u32| Draw { seed: 3, t, uav: 1 };
        (0..DRAWS).map(move |t| head.sample(outputs, MotionMap::Udlrs, draw(t)))
    }

    // The test compares the frequency of each motion, and the mean and variance of the pilot
    // density: α/(α+β), αβ/((α+β)²(α+β+1)).
    #[test]
    fn hybrid_samples_follow_the_distribution() {
        for pilot in [[2.0f32, 0.0], [-40.0, -40.0], [-3.0, 5.0]] {
            let outputs = [0.0, 1.0, -1.0, 0.5, 0.0, pilot[0], pilot[1]];
            let (mut counts, mut sum, mut squares) = ([0.0f64; MOTIONS], 0.0, 0.0);
            for [direction, pilot] in draws(Head::Hybrid, &outputs) {
                assert!((-1.0..=1.0).contains(&pilot));
                counts[((direction + 1.0) / 0.4) as usize] += 1.0;
                let pilot = (f64::from(pilot) + 1.0) / 2.0;
                sum += pilot;
                squares += pilot * pilot;
            }
            let total: f64 = outputs[..MOTIONS].iter().map(|&x| f64::from(x).exp()).sum();
            for (count, &logit) in counts.iter().zip(&outputs) {
                let expected = f64::from(logit).exp() / total;
                assert!((count / f64::from(DRAWS) - expected).abs() < 0.01);
            }
            let (a, b) = concentrations(&outputs);
            let mean = sum / f64::from(DRAWS);
            assert!((mean - a / (a + b)).abs() < 0.005, "{mean}");
            let variance = squares / f64::from(DRAWS) - mean * mean;
            let expected = a * b / ((a + b) * (a + b) * (a + b + 1.0));
            assert!(
                (variance / expected - 1.0).abs() < 0.04,
                "{variance} {expected}"
            );
        }
    }

    // With means 0.1 and -0.2 and deviations e⁻² and e⁻¹·⁵, clipping is five deviations away or
    // rare.
    #[test]
    fn gaussian_samples_follow_the_distribution() {
        let outputs = [0.1f32, -0.2, -2.0, -1.5];
        for axis in 0..2 {
            let (mut sum, mut squares) = (0.0, 0.0);
            for action in draws(Head::Gaussian, &outputs) {
                let u = f64::from(action[axis]);
                sum += u;
                squares += u * u;
            }
            let mean = sum / f64::from(DRAWS);
            let deviation = (squares / f64::from(DRAWS) - mean * mean).sqrt();
            assert!((mean - f64::from(outputs[axis])).abs() < 0.005);
            let expected = f64::from(outputs[2 + axis]).exp();
            assert!((deviation / expected - 1.0).abs() < 0.02, "{deviation}");
        }
    }

    #[test]
    fn the_most_likely_motion_and_the_mean_pilot_stand_for_the_whole() {
        let ln_e_minus_one = (core::f32::consts::E - 1.0).ln();
        let outputs = [0.0, 0.3, 2.0, 0.5, 0.0, ln_e_minus_one, ln_e_minus_one];
        let [direction, pilot] = Head::Hybrid.deterministic(&outputs, MotionMap::Udlrs);
        assert!(direction.abs() < 1e-6 && pilot.abs() < 1e-6);
        assert_eq!(
            Head::Gaussian.deterministic(&[1.5, -0.25, 0.0, 0.0], MotionMap::Udlrs),
            [1.0, -0.25]
        );
    }
}
