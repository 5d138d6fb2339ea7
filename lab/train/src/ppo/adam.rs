//! Adam over one flat parameter vector, with the gradient's norm clipped first.
//!
//! One pass over memory instead of one tensor operation for each term, and its state is two plain
//! vectors, so a checkpoint holds it exactly.

/// Moments and step count of Adam (Kingma & Ba, 2015).
#[derive(Clone, Debug, PartialEq)]
pub struct Adam {
    /// Updates made.
    pub steps: u64,
    /// First moment, one entry for each parameter.
    pub mean: Vec<f32>,
    /// Second moment.
    pub square: Vec<f32>,
}

const BETA_MEAN: f64 = 0.9;
const BETA_SQUARE: f64 = 0.999;
const EPSILON: f32 = 1e-5;

impl Adam {
    /// For that many parameters.
    pub fn new(parameters: usize) -> Adam {
        Adam {
            steps: 0,
            mean: vec![0.0; parameters],
            square: vec![0.0; parameters],
        }
    }

    /// One update; returns the gradient's norm before it was clipped to `max_norm`.
    pub fn step(
        &mut self,
        parameters: &mut [f32],
        gradient: &[f32],
        learning_rate: f64,
        max_norm: f32,
    ) -> f32 {
        let norm = sum_of_squares(gradient).sqrt() as f32;
        // A gradient that overflowed would spoil every later update; this one is left out.
        if !norm.is_finite() {
            return norm;
        }
        let scale = if norm > max_norm {
            max_norm / norm
        } else {
            1.0
        };
        self.steps += 1;
        let steps = self.steps.min(i32::MAX as u64) as i32;
        let mean_correction = 1.0 - BETA_MEAN.powi(steps);
        let square_correction = 1.0 - BETA_SQUARE.powi(steps);
        let rate = (learning_rate / mean_correction) as f32;
        let root_correction = (1.0 / square_correction).sqrt() as f32;
        let (b1, b2) = (BETA_MEAN as f32, BETA_SQUARE as f32);
        let state = self.mean.iter_mut().zip(&mut self.square);
        for ((parameter, &g), (mean, square)) in parameters.iter_mut().zip(gradient).zip(state) {
            let g = g * scale;
            *mean = b1 * *mean + (1.0 - b1) * g;
            *square = b2 * *square + (1.0 - b2) * g * g;
            *parameter -= rate * *mean / (square.sqrt() * root_correction + EPSILON);
        }
        norm
    }
}

/// Summed in lanes: a sum number by number would wait for each addition.
fn sum_of_squares(numbers: &[f32]) -> f64 {
    const LANES: usize = 16;
    let (whole, rest) = numbers.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for chunk in whole {
        for (sum, &number) in sums.iter_mut().zip(chunk) {
            *sum += f64::from(number) * f64::from(number);
        }
    }
    let rest = rest.iter().map(|&number| f64::from(number).powi(2));
    sums.iter().sum::<f64>() + rest.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    // The first step of Adam moves each parameter by the learning rate against the sign.
    #[test]
    fn the_first_step_has_the_length_of_the_learning_rate() {
        let mut adam = Adam::new(2);
        let mut parameters = [1.0, -1.0];
        let norm = adam.step(&mut parameters, &[0.3, -0.4], 0.01, 10.0);
        assert!((norm - 0.5).abs() < 1e-6);
        assert!((parameters[0] - 0.99).abs() < 1e-5 && (parameters[1] + 0.99).abs() < 1e-5);
    }

    // Second step by hand: m = 0.9·0.05 + 0.1·1 = 0.145 (g₁ = 0.5, g₂ = 1),
    // v = 0.999·2.5e-4 + 1e-3 = 1.24975e-3; m̂ = 0.145/0.19, v̂ = 1.24975e-3/1.999e-3.
    #[test]
    fn the_second_step_follows_the_moments() {
        let mut adam = Adam::new(1);
        let mut parameters = [0.0];
        adam.step(&mut parameters, &[0.5], 0.1, 10.0);
        let before = parameters[0];
        adam.step(&mut parameters, &[1.0], 0.1, 10.0);
        let m_hat: f64 = 0.145 / 0.19;
        let v_hat: f64 = 1.24975e-3 / 1.999e-3;
        let expected = 0.1 * m_hat / (v_hat.sqrt() + 1e-5);
        assert!((f64::from(before - parameters[0]) - expected).abs() < 1e-5);
    }

    // 1² + 2² + … + 37² = 37·38·75/6.
    #[test]
    fn squares_beyond_the_last_whole_lane_count() {
        let numbers: Vec<f32> = (1u8..=37).map(f32::from).collect();
        assert!((sum_of_squares(&numbers) - 17575.0).abs() < 1e-9);
    }

    #[test]
    fn a_long_gradient_is_clipped_and_a_broken_one_left_out() {
        let mut clipped = Adam::new(1);
        let mut plain = Adam::new(1);
        let (mut a, mut b) = ([0.0], [0.0]);
        clipped.step(&mut a, &[50.0], 0.1, 0.5);
        plain.step(&mut b, &[0.5], 0.1, 0.5);
        assert_eq!(a, b);
        let before = plain.clone();
        plain.step(&mut b, &[f32::NAN], 0.1, 0.5);
        assert_eq!(plain, before);
    }
}
