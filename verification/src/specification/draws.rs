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
const FALSE_ALARM: u32 = 8;
const START_CELL: u32 = 9;

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

/// The rank of the cell in which UAV i starts, uniform in 0..cells.
pub fn start_rank(seed: u64, i: usize, cells: u64) -> u64 {
    below(first_u64(block(seed, [0, i as u32, 0, START_CELL])), cells)
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

/// Draws how many of n cells raise a false alarm, each with probability p; at most `most`.
///
/// The number is above k where the word is at least floor(P(X <= k) 2^32).
pub fn alarm_count(seed: u64, t: u32, i: usize, n: usize, p: f64, most: usize) -> usize {
    let word = f64::from(block(seed, [t, i as u32, 0, FALSE_ALARM])[0]);
    let mut at_most = 0.0;
    let mut count = 0;
    for k in 0..most.min(n) {
        at_most += binomial(n, k, p);
        if word >= libm::floor(at_most * 4_294_967_296.0) {
            count += 1;
        }
    }
    count
}

/// P(X = k) for a binomial X over n trials of probability p.
pub fn binomial(n: usize, k: usize, p: f64) -> f64 {
    let mut ways = 1.0;
    for j in 0..k {
        ways *= (n - j) as f64 / (j + 1) as f64;
    }
    ways * libm::pow(p, k as f64) * libm::pow(1.0 - p, (n - k) as f64)
}

/// Draws `count` distinct ranks of 0..n by Floyd's sampling.
pub fn alarm_ranks(seed: u64, t: u32, i: usize, count: usize, n: usize) -> Vec<usize> {
    let mut chosen: Vec<usize> = Vec::new();
    for k in 0..count {
        let top = n - count + k;
        let draw = first_u64(block(seed, [t, i as u32, 1 + k as u32, FALSE_ALARM]));
        let rank = below(draw, top as u64 + 1) as usize;
        chosen.push(if chosen.contains(&rank) { top } else { rank });
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
