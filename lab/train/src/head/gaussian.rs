//! The paper's head: a 2-D normal whose samples are clipped to [-1, 1]².
//!
//! As in RLlib, the actor gives means and log standard deviations, and the density is that of the
//! sample before clipping.

use super::Densities;
use burn_tensor::{Tensor, TensorData};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Two means, then two log standard deviations.
pub const OUTPUT_LEN: usize = 4;

/// Bounds of the log standard deviation: from a quarter of a motion bin to beyond the range.
const LOG_STD: [f32; 2] = [-2.3, 1.0];

const HALF_LN_TAU: f32 = 0.918_938_5;

pub(super) fn sample(outputs: &[f32], random: &mut ChaCha8Rng) -> ([f32; 2], [f32; 2]) {
    let (mut raw, mut log_probs) = ([0.0; 2], [0.0; 2]);
    for axis in 0..2 {
        let log_std = outputs[2 + axis].clamp(LOG_STD[0], LOG_STD[1]);
        let z: f32 = StandardNormal.sample(random);
        raw[axis] = outputs[axis] + log_std.exp() * z;
        log_probs[axis] = -0.5 * z * z - log_std - HALF_LN_TAU;
    }
    (raw, log_probs)
}

pub(super) fn densities(outputs: Tensor<2>, raw: &[f32]) -> Densities {
    let rows = outputs.dims()[0];
    let device = outputs.device();
    let raw = Tensor::<2>::from_data(TensorData::new(raw.to_vec(), [rows, 2]), &device);
    let mean = outputs.clone().narrow(1, 0, 2);
    let log_std = outputs.narrow(1, 2, 2).clamp(LOG_STD[0], LOG_STD[1]);
    let z = (raw - mean) / log_std.clone().exp();
    let log_probs = (z.square().mul_scalar(-0.5) - log_std.clone()).sub_scalar(HALF_LN_TAU);
    let entropies = log_std.add_scalar(0.5 + HALF_LN_TAU);
    Densities {
        log_probs,
        entropies,
    }
}

pub(super) fn motion_densities(outputs: Tensor<2>, raw: &[f32]) -> Densities {
    let both = densities(outputs, raw);
    Densities {
        log_probs: both.log_probs.narrow(1, 0, 1),
        entropies: both.entropies.narrow(1, 0, 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::values;
    use burn_tensor::Device;

    // N(0.5, 1) at 1.5 and N(-0.25, e^-1) at -0.25: closed forms of the normal density.
    #[test]
    fn densities_match_the_closed_form() {
        let outputs = Tensor::<2>::from_data(
            TensorData::new(vec![0.5f32, -0.25, 0.0, -1.0], [1, 4]),
            &Device::flex(),
        );
        let densities = densities(outputs, &[1.5, -0.25]);
        let log_probs = values(densities.log_probs);
        for (log_prob, expected) in log_probs
            .iter()
            .zip([-0.5 - HALF_LN_TAU, 1.0 - HALF_LN_TAU])
        {
            assert!((log_prob - expected).abs() < 1e-6);
        }
        // Entropy of a normal: ½ ln(2πe σ²), summed over both components.
        let expected = 2.0 * (0.5 + HALF_LN_TAU) - 1.0;
        assert!((densities.entropies.sum().into_scalar::<f32>() - expected).abs() < 1e-6);
    }

    #[test]
    fn a_sample_carries_the_density_that_the_tensors_give() {
        let mut random = crate::random::stream(3, 0);
        let outputs = [0.2f32, -0.6, -0.7, 0.4];
        for _ in 0..50 {
            let (raw, log_probs) = sample(&outputs, &mut random);
            let tensor =
                Tensor::<2>::from_data(TensorData::new(outputs.to_vec(), [1, 4]), &Device::flex());
            let from_tensors = values(densities(tensor, &raw).log_probs);
            for (log_prob, from_tensors) in log_probs.iter().zip(from_tensors) {
                assert!((log_prob - from_tensors).abs() < 1e-5);
            }
        }
    }
}
