//! Running mean and variance of value targets; the fixed scaling of inputs in files of other
//! trainers.

use serde::{Deserialize, Serialize};

/// Mean and variance of each field over everything seen (Chan et al.'s parallel update).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Running {
    /// Rows seen.
    pub count: f64,
    /// Mean of each field.
    pub mean: Vec<f64>,
    /// Sum of squared deviations of each field.
    pub deviation: Vec<f64>,
}

impl Running {
    /// Empty statistics, which scale nothing.
    pub fn new(fields: usize) -> Running {
        Running {
            count: 0.0,
            mean: vec![0.0; fields],
            deviation: vec![0.0; fields],
        }
    }

    /// Takes in a batch of rows.
    pub fn update(&mut self, rows: &[f32]) {
        let fields = self.mean.len();
        let count = (rows.len() / fields) as f64;
        if count == 0.0 {
            return;
        }
        let mut mean = vec![0.0; fields];
        for row in rows.chunks_exact(fields) {
            for (sum, &x) in mean.iter_mut().zip(row) {
                *sum += f64::from(x);
            }
        }
        mean.iter_mut().for_each(|sum| *sum /= count);
        let mut deviation = vec![0.0; fields];
        for row in rows.chunks_exact(fields) {
            for ((sum, &x), mean) in deviation.iter_mut().zip(row).zip(&mean) {
                *sum += (f64::from(x) - mean) * (f64::from(x) - mean);
            }
        }
        let total = self.count + count;
        for field in 0..fields {
            let gap = mean[field] - self.mean[field];
            self.mean[field] += gap * count / total;
            self.deviation[field] += deviation[field] + gap * gap * self.count * count / total;
        }
        self.count = total;
    }

    /// Standard deviation of each field; 1 for a constant field.
    pub fn scale(&self) -> Vec<f32> {
        self.deviation
            .iter()
            .map(|deviation| {
                let variance = deviation / self.count.max(1.0);
                if variance > 1e-6 {
                    variance.sqrt() as f32
                } else {
                    1.0
                }
            })
            .collect()
    }

    /// Mean of each field.
    pub fn offset(&self) -> Vec<f32> {
        self.mean.iter().map(|&mean| mean as f32).collect()
    }
}

/// A fixed affine map of inputs, (x − offset)/scale clipped to ±[`CLIP`]; empty maps nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Affine {
    /// Subtracted first.
    pub offset: Vec<f32>,
    /// Divided by next.
    pub scale: Vec<f32>,
}

/// Normalised inputs are clipped to this many standard deviations.
pub const CLIP: f32 = 10.0;

impl Affine {
    /// Maps rows in place.
    pub fn apply(&self, rows: &mut [f32]) {
        if self.offset.is_empty() {
            return;
        }
        for row in rows.chunks_exact_mut(self.offset.len()) {
            for ((x, offset), scale) in row.iter_mut().zip(&self.offset).zip(&self.scale) {
                *x = ((*x - offset) / scale).clamp(-CLIP, CLIP);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // 1, 2, 3, 4: mean 2.5, variance 1.25, in one batch or in two.
    #[test]
    fn batches_add_up_to_the_whole() {
        let mut whole = Running::new(1);
        whole.update(&[1.0, 2.0, 3.0, 4.0]);
        let mut parts = Running::new(1);
        parts.update(&[1.0]);
        parts.update(&[2.0, 3.0, 4.0]);
        for running in [whole, parts] {
            assert!((running.mean[0] - 2.5).abs() < 1e-12);
            assert!((running.scale()[0] - 1.25f32.sqrt()).abs() < 1e-6);
        }
    }

    #[test]
    fn a_constant_field_is_centred_and_not_scaled() {
        let mut running = Running::new(2);
        running.update(&[3.0, 0.0, 3.0, 2.0]);
        assert_eq!(running.offset(), [3.0, 1.0]);
        assert_eq!(running.scale(), [1.0, 1.0]);
    }

    #[test]
    fn inputs_are_scaled_and_clipped() {
        let inputs = Affine {
            offset: vec![1.0, 0.0],
            scale: vec![2.0, 0.01],
        };
        let mut rows = [5.0, 1.0];
        inputs.apply(&mut rows);
        assert_eq!(rows, [2.0, CLIP]);
    }
}
