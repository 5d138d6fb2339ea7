//! Orthogonal initial weights (Saxe et al., 2014), the usual start for PPO with ReLU.

use super::Param;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Orthogonal matrices with gain √2, zero biases, and `output_gain` for the last matrix.
pub(super) fn orthogonal(blocks: &[Param], output_gain: f64, random: &mut ChaCha8Rng) -> Vec<f32> {
    let last = blocks.iter().rposition(|block| block.rows > 1).unwrap_or(0);
    let mut parameters = Vec::new();
    for (index, block) in blocks.iter().enumerate() {
        if block.rows == 1 {
            parameters.extend(std::iter::repeat_n(0.0, block.len()));
        } else {
            let gain = if index == last {
                output_gain
            } else {
                std::f64::consts::SQRT_2
            };
            parameters.extend(matrix(block.rows, block.columns, gain, random));
        }
    }
    parameters
}

/// A rows × columns matrix whose shorter side is orthonormal, times `gain`.
fn matrix(rows: usize, columns: usize, gain: f64, random: &mut ChaCha8Rng) -> Vec<f32> {
    let (vectors, length) = (rows.min(columns), rows.max(columns));
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(vectors);
    for _ in 0..vectors {
        let mut vector: Vec<f64> = (0..length).map(|_| StandardNormal.sample(random)).collect();
        for earlier in &basis {
            let overlap: f64 = vector.iter().zip(earlier).map(|(a, b)| a * b).sum();
            vector
                .iter_mut()
                .zip(earlier)
                .for_each(|(a, b)| *a -= overlap * b);
        }
        let norm = vector.iter().map(|a| a * a).sum::<f64>().sqrt();
        vector.iter_mut().for_each(|a| *a /= norm);
        basis.push(vector);
    }
    let entry = |row: usize, column: usize| {
        if rows <= columns {
            basis[row][column]
        } else {
            basis[column][row]
        }
    };
    (0..rows * columns)
        .map(|index| (gain * entry(index / columns, index % columns)) as f32)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shorter_side_is_orthonormal_times_the_gain() {
        let mut random = crate::random::stream(1, 0);
        let (rows, columns) = (7, 4);
        let matrix = matrix(rows, columns, 2.0, &mut random);
        for a in 0..columns {
            for b in 0..columns {
                let dot: f32 = (0..rows)
                    .map(|row| matrix[row * columns + a] * matrix[row * columns + b])
                    .sum();
                let expected = if a == b { 4.0 } else { 0.0 };
                assert!((dot - expected).abs() < 1e-5, "columns {a}, {b}: {dot}");
            }
        }
    }
}
