//! The tables of false alarms: sizes of footprints, and the thresholds of a draw for each size.

use libm::{exp, log1p};

use super::footprint;
use crate::config::{Cell, Config};

/// The most false alarms of a UAV in a step. More of them count as this.
pub const ALARMS_MAX: usize = 8;

/// Number of values of a draw.
const DRAWS: u64 = 1 << 32;

/// Number of words of the tables of false alarms. They hold the size of the footprint around each
/// cell, and then the thresholds of each size from 0.
pub(crate) fn table_words(config: &Config) -> usize {
    if config.false_alarm_per_cell == 0.0 {
        return 0;
    }
    let footprint = footprint::of(config);
    let sizes = footprint.size_max(config.grid_width, config.grid_height) as usize + 1;
    config.cell_count() + sizes * ALARMS_MAX
}

/// Fills the tables of false alarms.
pub(crate) fn tabulate(config: &Config, words: &mut [u64]) {
    if words.is_empty() {
        return;
    }
    let (footprint, width) = (footprint::of(config), config.grid_width);
    let (sizes, rows) = words.split_at_mut(config.cell_count());
    for (index, word) in (0..).zip(sizes) {
        let cell = Cell {
            x: index % width,
            y: index / width,
        };
        *word = u64::from(footprint.size(cell, width, config.grid_height));
    }
    for (cells, row) in (0..).zip(rows.chunks_exact_mut(ALARMS_MAX)) {
        row.copy_from_slice(&thresholds(cells, config.false_alarm_per_cell));
    }
}

/// The thresholds of a footprint of `cells` cells.
///
/// Entry k is the whole part of P(X ≤ k) · 2^32, for a binomial number X of alarms. The entries do
/// not fall, and are at most 2^32.
// Proof: proofs/alarms.rs, thresholds_rise_within_the_draws
#[must_use]
pub fn thresholds(cells: u32, per_cell: f64) -> [u64; ALARMS_MAX] {
    let (all, odds) = (f64::from(cells), per_cell / (1.0 - per_cell));
    let mut probability = exp(bounded(all * log1p(-per_cell)));
    let mut at_most = probability;
    let mut row = [DRAWS; ALARMS_MAX];
    for (k, threshold) in row.iter_mut().enumerate() {
        if k as u32 >= cells {
            break;
        }
        *threshold = threshold_of(at_most);
        probability = next(k as f64, all, odds, probability);
        at_most = plus(at_most, probability);
    }
    row
}

/// The whole part of a probability times 2^32, at most 2^32.
// Proof: proofs/alarms.rs, thresholds_rise_with_their_probability
pub(crate) fn threshold_of(at_most: f64) -> u64 {
    let scaled = at_most * DRAWS as f64;
    if scaled < DRAWS as f64 {
        scaled as u64
    } else {
        DRAWS
    }
}

/// P(X = k + 1), from P(X = k).
// Proof: proofs/alarms.rs, a_probability_is_not_negative
pub(crate) fn next(k: f64, all: f64, odds: f64, probability: f64) -> f64 {
    probability * ((all - k) / (k + 1.0) * odds)
}

/// P(X ≤ k + 1), from P(X ≤ k) and P(X = k + 1).
// Proof: proofs/alarms.rs, a_sum_is_not_below_its_part
pub(crate) fn plus(at_most: f64, probability: f64) -> f64 {
    at_most + probability
}

/// The exponent, or -700 below it: e^-700 counts as 0 at the resolution of a draw.
const fn bounded(exponent: f64) -> f64 {
    if exponent < -700.0 { -700.0 } else { exponent }
}

/// The number of alarms that a 32-bit draw gives: that of the thresholds that are not above it.
#[inline(always)]
#[must_use]
pub fn count(draw: u32, thresholds: &[u64]) -> u32 {
    let mut count = 0;
    for &threshold in thresholds {
        count += u32::from(u64::from(draw) >= threshold);
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    /// P(X <= k) for 29 cells at 1 %, by `scipy.stats.binom.cdf(range(8), 29, 0.01)`.
    #[test]
    fn thresholds_are_those_of_a_statistics_library() {
        let expected = [
            0.747_172_094_331_596_4,
            0.966_040_687_620_649_9,
            0.996_991_801_823_142_3,
            0.999_805_539_477_914_3,
            0.999_990_279_828_985_3,
            0.999_999_610_149_746_4,
            0.999_999_987_132_403_3,
            0.999_999_999_644_093_3,
        ];
        for (threshold, cdf) in thresholds(29, 0.01).into_iter().zip(expected) {
            let difference = threshold as f64 / DRAWS as f64 - cdf;
            assert!(difference.abs() < 1e-9, "{difference}");
        }
    }

    /// No cell, no alarm; and a threshold for each count of alarms that a few cells cannot exceed.
    #[test]
    fn no_footprint_raises_more_alarms_than_it_has_cells() {
        assert_eq!(thresholds(0, 0.5), [DRAWS; ALARMS_MAX]);
        let two = thresholds(2, 0.5);
        assert_eq!(two[..3], [DRAWS / 4, DRAWS / 4 * 3, DRAWS]);
        assert_eq!(count(u32::MAX, &two), 2);
        assert_eq!(count(0, &two), 0);
        // With 2^20 cells P(X <= 7) is 0 at the resolution of a draw.
        assert_eq!(count(0, &thresholds(1 << 20, 0.5)), 8);
    }
}
