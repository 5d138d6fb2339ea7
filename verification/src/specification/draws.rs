//! The counter of each random draw, and the distribution that its words give.
//!
//! The counter words are the step, the UAV, the block within the draw and the purpose. Draws of a
//! reset have step 0. Draws of a step have the time after the step.

use super::philox::{block, first_u64};

const DETECT: u32 = 1;
const CARBON: u32 = 2;
const SOC: u32 = 3;
const HOTSPOT: u32 = 4;
const SHUFFLE: u32 = 5;
const SEED: u32 = 6;

/// One Bernoulli(p) draw for UAV i and hotspot j in step t.
///
/// A word is below floor(p · 2³²) with that probability, in integers.
pub fn detects(seed: u64, t: u32, i: usize, j: usize, p: f64) -> bool {
    let two_to_32 = 4_294_967_296.0;
    let scaled = libm::floor(p * two_to_32);
    let threshold = if scaled <= 0.0 {
        0
    } else if scaled >= two_to_32 {
        1u64 << 32
    } else {
        scaled as u64
    };
    let words = block(seed, [t, i as u32, (j / 4) as u32, DETECT]);
    u64::from(words[j % 4]) < threshold
}

/// The carbon intensity drawn at time t, uniform in lo..=hi mg/kWh.
pub fn carbon_intensity(seed: u64, t: u32, lo: u64, hi: u64) -> u64 {
    let draw = first_u64(block(seed, [t, 0, 0, CARBON]));
    lo + below(draw, hi - lo + 1)
}

/// The state of charge that UAV i starts with, uniform in [lo, hi).
pub fn initial_soc(seed: u64, i: usize, lo: f64, hi: f64) -> f64 {
    lo + (hi - lo) * unit(first_u64(block(seed, [0, i as u32, 0, SOC])))
}

/// Returns a real in [0, 1) from 64 random bits.
fn unit(draw: u64) -> f64 {
    (draw >> 11) as f64 / 9_007_199_254_740_992.0
}

/// Draws n distinct ranks of 0..m in random order, by Floyd's sampling and a shuffle.
pub fn distinct_ranks(seed: u64, n: usize, m: usize) -> Vec<u64> {
    let mut chosen: Vec<u64> = Vec::new();
    for k in 0..n {
        let top = (m - n + k) as u64;
        let draw = first_u64(block(seed, [0, 0, k as u32, HOTSPOT]));
        let rank = below(draw, top + 1);
        chosen.push(if chosen.contains(&rank) { top } else { rank });
    }
    for k in (1..n).rev() {
        let draw = first_u64(block(seed, [0, 0, k as u32, SHUFFLE]));
        let other = below(draw, k as u64 + 1) as usize;
        chosen.swap(k, other);
    }
    chosen
}

/// Derives the seed of the episode with an index from `seed`.
pub fn derive_seed(seed: u64, index: u64) -> u64 {
    let counter = [index as u32, (index >> 32) as u32, 0, SEED];
    first_u64(block(seed, counter))
}

/// Returns a number below `bound` from 64 random bits: the high half of the product.
fn below(draw: u64, bound: u64) -> u64 {
    ((u128::from(draw) * u128::from(bound)) >> 64) as u64
}
