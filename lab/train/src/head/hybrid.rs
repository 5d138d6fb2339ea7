//! A categorical motion and a Beta-distributed pilot density, independent given the observation.
//!
//! Motion has no order, so a normal over five bins has to pass through one motion to reach
//! another; a categorical does not. The Beta lives on the pilot range itself and needs no clipping.

use super::Densities;
use burn_tensor::activation::{log_softmax, softplus};
use burn_tensor::{Int, Tensor, TensorData};
use jcas_policy::head::MOTIONS;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Beta, Distribution};

/// Five motion logits, then the two Beta parameters before α, β = 1 + softplus.
pub const OUTPUT_LEN: usize = MOTIONS + 2;

/// Pilot samples stay this far inside (0, 1), where the Beta density is finite.
const MARGIN: f32 = 1e-4;

fn log_softmax_slice(logits: &[f32]) -> [f64; MOTIONS] {
    let max = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let mut shifted = [0.0; MOTIONS];
    for (out, logit) in shifted.iter_mut().zip(logits) {
        *out = f64::from(logit - max);
    }
    let log_sum = shifted.iter().map(|x| x.exp()).sum::<f64>().ln();
    shifted.map(|x| x - log_sum)
}

fn softplus_scalar(x: f32) -> f64 {
    let x = f64::from(x);
    x.max(0.0) + (-x.abs()).exp().ln_1p()
}

fn concentrations(outputs: &[f32]) -> (f64, f64) {
    (
        1.0 + softplus_scalar(outputs[MOTIONS]),
        1.0 + softplus_scalar(outputs[MOTIONS + 1]),
    )
}

/// ln Γ(z) for z ≥ 1: Stirling's series at z + 5, brought back by the recurrence.
fn ln_gamma(z: f64) -> f64 {
    let w = z + 5.0;
    let product = z * (z + 1.0) * (z + 2.0) * (z + 3.0) * (z + 4.0);
    let series = 1.0 / (12.0 * w) - 1.0 / (360.0 * w * w * w);
    (w - 0.5) * w.ln() - w + 0.918_938_533_204_672_7 + series - product.ln()
}

fn beta_log_density(alpha: f64, beta: f64, x: f64) -> f64 {
    (alpha - 1.0) * x.ln() + (beta - 1.0) * (1.0 - x).ln() + ln_gamma(alpha + beta)
        - ln_gamma(alpha)
        - ln_gamma(beta)
}

/// A drawn motion and a drawn pilot density.
pub(super) fn sample(outputs: &[f32], random: &mut ChaCha8Rng) -> ([f32; 2], [f32; 2]) {
    let log_probs = log_softmax_slice(&outputs[..MOTIONS]);
    let mut left: f64 = random.random();
    let mut motion = MOTIONS - 1;
    for (candidate, log_prob) in log_probs.iter().enumerate() {
        left -= log_prob.exp();
        if left < 0.0 {
            motion = candidate;
            break;
        }
    }
    let (alpha, beta) = concentrations(outputs);
    let pilot: f64 = Beta::new(alpha, beta).expect("α, β ≥ 1").sample(random);
    let pilot = (pilot as f32).clamp(MARGIN, 1.0 - MARGIN);
    let pilot_log_prob = beta_log_density(alpha, beta, f64::from(pilot));
    let log_probs = [log_probs[motion], pilot_log_prob].map(|log_prob| log_prob as f32);
    ([motion as f32, pilot], log_probs)
}

/// The tensor twin of [`ln_gamma`].
fn ln_gamma_tensor(z: Tensor<2>) -> Tensor<2> {
    let w = z.clone().add_scalar(5.0);
    let product = z.clone()
        * z.clone().add_scalar(1.0)
        * z.clone().add_scalar(2.0)
        * z.clone().add_scalar(3.0)
        * z.add_scalar(4.0);
    let inverse = w.clone().recip();
    let series = inverse.clone().div_scalar(12.0)
        - (inverse.clone() * inverse.clone() * inverse).div_scalar(360.0);
    w.clone().sub_scalar(0.5) * w.clone().log() - w + series - product.log()
        + 0.918_938_533_204_672_7
}

/// ψ(z) for z ≥ 1, the derivative of the series in [`ln_gamma`].
fn digamma_tensor(z: Tensor<2>) -> Tensor<2> {
    let w = z.clone().add_scalar(5.0);
    let inverse = w.clone().recip();
    let square = inverse.clone().square();
    let mut psi = w.log() - inverse.mul_scalar(0.5) - square.clone().div_scalar(12.0)
        + square.square().div_scalar(120.0);
    for shift in 0..5 {
        psi = psi - z.clone().add_scalar(f64::from(shift)).recip();
    }
    psi
}

fn motions_tensor(raw: &[f32], like: &Tensor<2>) -> Tensor<2, Int> {
    let motions: Vec<i64> = raw.chunks_exact(2).map(|pair| pair[0] as i64).collect();
    let rows = motions.len();
    Tensor::<2, Int>::from_data(TensorData::new(motions, [rows, 1]), &like.device())
}

fn pilots_tensor(raw: &[f32], like: &Tensor<2>) -> Tensor<2> {
    let pilots: Vec<f32> = raw.chunks_exact(2).map(|pair| pair[1]).collect();
    let rows = pilots.len();
    Tensor::<2>::from_data(TensorData::new(pilots, [rows, 1]), &like.device())
}

pub(super) fn motion_densities(outputs: &Tensor<2>, raw: &[f32]) -> Densities {
    let log_probs = log_softmax(outputs.clone().narrow(1, 0, MOTIONS), 1);
    Densities {
        log_probs: log_probs.clone().gather(1, motions_tensor(raw, outputs)),
        entropies: (log_probs.clone().exp() * log_probs).sum_dim(1).neg(),
    }
}

pub(super) fn densities(outputs: Tensor<2>, raw: &[f32]) -> Densities {
    let motion = motion_densities(&outputs, raw);
    let pilot = pilots_tensor(raw, &outputs);
    // Columns α, β, α + β, so that each special function runs once.
    let ab = softplus(outputs.narrow(1, MOTIONS, 2), 1.0).add_scalar(1.0);
    let sum = ab.clone().sum_dim(1);
    let abs = Tensor::cat(vec![ab.clone(), sum.clone()], 1);
    let log_gammas = ln_gamma_tensor(abs.clone());
    let log_norm = log_gammas.clone().narrow(1, 2, 1) - log_gammas.narrow(1, 0, 2).sum_dim(1);
    let logs = Tensor::cat(
        vec![pilot.clone().log(), pilot.neg().add_scalar(1.0).log()],
        1,
    );
    let excess = ab.sub_scalar(1.0);
    let pilot_log_prob = (excess.clone() * logs).sum_dim(1) + log_norm.clone();
    let psi = digamma_tensor(abs);
    let pilot_entropy = sum.sub_scalar(2.0) * psi.clone().narrow(1, 2, 1)
        - (excess * psi.narrow(1, 0, 2)).sum_dim(1)
        - log_norm;

    Densities {
        log_probs: Tensor::cat(vec![motion.log_probs, pilot_log_prob], 1),
        entropies: Tensor::cat(vec![motion.entropies, pilot_entropy], 1),
    }
}

/// Cross-entropies of a teacher's actions (rows × 2): those of motions, then of pilot densities.
///
/// Let y be the place of a density in its range, and m the mean of the Beta. The second is
/// −y ln m − (1 − y) ln(1 − m). The likelihood under the Beta would have no greatest value, as a
/// teacher's densities lie at the bounds of the range.
pub fn label_losses(outputs: Tensor<2>, labels: &[f32]) -> Tensor<2> {
    let motions = motion_densities(&outputs, labels).log_probs.neg();
    let places = pilots_tensor(labels, &outputs);
    let ab = softplus(outputs.narrow(1, MOTIONS, 2), 1.0).add_scalar(1.0);
    let shares = ab.clone() / ab.sum_dim(1);
    let targets = Tensor::cat(vec![places.clone(), places.neg().add_scalar(1.0)], 1);
    let pilots = (targets * shares.log()).sum_dim(1).neg();
    Tensor::cat(vec![motions, pilots], 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{matrix, values};
    use burn_tensor::Device;
    use jcas_core::MotionMap;
    use jcas_policy::head::Head;

    fn of(raw: [f32; 2], outputs: [f32; OUTPUT_LEN]) -> (f32, f32) {
        let outputs = Tensor::<2>::from_data(
            TensorData::new(outputs.to_vec(), [1, OUTPUT_LEN]),
            &Device::flex(),
        );
        let densities = densities(outputs, &raw);
        (
            densities.log_probs.sum().into_scalar::<f32>(),
            densities.entropies.sum().into_scalar::<f32>(),
        )
    }

    // Equal logits cost ln 5, and α = 2, β = 1 has the mean 2/3.
    #[test]
    fn labels_cost_their_cross_entropy() {
        let ln_e_minus_one = (std::f32::consts::E - 1.0).ln();
        let row = [0.0, 0.0, 0.0, 0.0, 0.0, ln_e_minus_one, -40.0];
        let outputs = matrix(row.repeat(3), OUTPUT_LEN, &Device::flex());
        let losses = values(label_losses(outputs, &[0.0, 0.0, 3.0, 1.0, 4.0, 0.5]));
        let expected = [5.0f32, 3.0, 5.0, 1.5, 5.0, 4.5f32.sqrt()].map(f32::ln);
        for (loss, expected) in losses.iter().zip(expected) {
            assert!((loss - expected).abs() < 1e-5, "{losses:?}");
        }
    }

    // ln Γ at integers is ln (n-1)!, at 3/2 it is ln(√π / 2).
    #[test]
    fn ln_gamma_matches_factorials_and_the_half_integer() {
        let mut factorial = 1.0f64;
        for n in 1..15 {
            assert!(
                (ln_gamma(f64::from(n)) - factorial.ln()).abs() < 1e-6,
                "n = {n}"
            );
            factorial *= f64::from(n);
        }
        let half = (std::f64::consts::PI.sqrt() / 2.0).ln();
        assert!((ln_gamma(1.5) - half).abs() < 1e-6);
    }

    // Equal logits: ln(1/5). softplus(ln(e-1)) = 1 gives Beta(2, 2): density 6x(1-x),
    // entropy ln B(2,2) - 2ψ(2) + 2ψ(4) = ln(1/6) + 2(1/2 + 1/3) = -0.125093.
    #[test]
    fn densities_match_the_closed_form_of_beta_2_2() {
        let one = (std::f32::consts::E - 1.0).ln();
        let (log_prob, entropy) = of([3.0, 0.25], [0.3, 0.3, 0.3, 0.3, 0.3, one, one]);
        let expected = (0.2f32).ln() + (6.0f32 * 0.25 * 0.75).ln();
        assert!((log_prob - expected).abs() < 1e-5, "{log_prob} {expected}");
        let expected = (5.0f32).ln() + (1.0f32 / 6.0).ln() + 2.0 * (0.5 + 1.0 / 3.0);
        assert!((entropy - expected).abs() < 1e-5, "{entropy} {expected}");
    }

    /// The policy crate computes α and β in pinned arithmetic, training in the platform's.
    #[test]
    fn training_and_flight_have_the_same_mean_pilot_density() {
        let inputs = (-12..=12).map(|k| 4.0 * k as f32);
        for (x, y) in inputs
            .clone()
            .flat_map(|x| inputs.clone().map(move |y| (x, y)))
        {
            let outputs = [0.0, 0.0, 0.0, 0.0, 0.0, x, y];
            let (alpha, beta) = concentrations(&outputs);
            let trained = 2.0 * alpha / (alpha + beta) - 1.0;
            let [_, flown] = Head::Hybrid.deterministic(&outputs, MotionMap::Udlrs);
            assert!(
                (f64::from(flown) - trained).abs() < 1e-6,
                "{x} {y}: {flown} {trained}"
            );
        }
    }

    #[test]
    fn a_sample_carries_the_density_that_the_tensors_give() {
        let mut random = crate::random::stream(5, 0);
        for round in 0..200 {
            let outputs: [f32; OUTPUT_LEN] =
                std::array::from_fn(|_| random.random_range(-3.0f32..6.0));
            let (raw, log_probs) = sample(&outputs, &mut random);
            let log_prob = log_probs[0] + log_probs[1];
            assert!((0.0..MOTIONS as f32).contains(&raw[0]) && (0.0..1.0).contains(&raw[1]));
            let (from_tensors, _) = of(raw, outputs);
            assert!(
                (log_prob - from_tensors).abs() < 2e-4,
                "round {round}: {log_prob} {from_tensors}"
            );
        }
    }

    // The frequency of each motion over many draws, and the pilot's mean α/(α+β).
    #[test]
    fn samples_follow_the_distribution() {
        let mut random = crate::random::stream(6, 0);
        let outputs = [0.0, 1.0, -1.0, 0.5, 0.0, 2.0, 0.0];
        let log_probs = log_softmax_slice(&outputs[..MOTIONS]);
        let (alpha, beta) = concentrations(&outputs);
        let (mut counts, mut pilot, draws) = ([0.0; MOTIONS], 0.0, 40_000);
        for _ in 0..draws {
            let (raw, _) = sample(&outputs, &mut random);
            counts[raw[0] as usize] += 1.0;
            pilot += f64::from(raw[1]);
        }
        for (count, log_prob) in counts.iter().zip(log_probs) {
            assert!((count / f64::from(draws) - log_prob.exp()).abs() < 0.01);
        }
        assert!((pilot / f64::from(draws) - alpha / (alpha + beta)).abs() < 0.01);
    }
}
