//! P8 and P13 for false alarms: their tables are in range. The cells of a UAV's alarms lie apart
//! and in its footprint. A false confirmation is never taken back.

// A negated comparison is true of a NaN, which it must be here.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::inputs::{between, does_not_fall, real_between};
#[cfg(not(kani))]
use super::standin as kani;
use crate::config::Cell;
use crate::radio::false_alarms::{ALARMS_MAX, next, plus, threshold_of, thresholds};
use crate::rules::alarms::sample;
use crate::words::geometry::Disc;

/// Cells along a side of the harness's grid: one beside the middle on every side.
const SIDE: u32 = 3;

/// The thresholds of a footprint do not fall, and none is above 2^32.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(10))]
#[cfg_attr(kani, kani::stub(libm::exp, crate::proofs::stubs::any_alarm_exp))]
#[cfg_attr(kani, kani::stub(libm::log1p, crate::proofs::stubs::any_log1p))]
#[cfg_attr(
    kani,
    kani::stub(crate::radio::false_alarms::next, crate::proofs::stubs::any_next)
)]
#[cfg_attr(
    kani,
    kani::stub(crate::radio::false_alarms::plus, crate::proofs::stubs::any_sum)
)]
pub fn thresholds_rise_within_the_draws() {
    let cells = between(0, 1 << 20) as u32;
    let row = thresholds(cells, real_between(0.0, 0.5));
    kani::cover!(row[0] < 1 << 31, "an alarm more often than not");
    kani::cover!(cells > 0 && cells < 8, "fewer cells than counted alarms");
    for k in 0..ALARMS_MAX {
        assert!(row[k] <= 1 << 32);
        assert!(k == 0 || row[k] >= row[k - 1]);
        assert!((k as u32) < cells || row[k] == 1 << 32);
    }
}

/// The next probability is not below 0, even after rounding or overflow before.
#[cfg_attr(kani, kani::proof)]
pub fn a_probability_is_not_negative() {
    let k = f64::from(between(0, ALARMS_MAX as u64 - 1) as u32);
    let (all, odds, probability): (f64, f64, f64) = (kani::any(), kani::any(), kani::any());
    kani::assume(all > k && odds >= 0.0 && !(probability < 0.0));
    let following = next(k, all, odds, probability);
    kani::cover!(following > probability, "a larger one");
    kani::cover!(following < probability, "a smaller one");
    assert!(!(following < 0.0));
}

/// A sum is not below its first part where the second is not below 0.
#[cfg_attr(kani, kani::proof)]
pub fn a_sum_is_not_below_its_part() {
    let (at_most, probability): (f64, f64) = (kani::any(), kani::any());
    kani::assume(!(at_most < 0.0) && !(probability < 0.0));
    let sum = plus(at_most, probability);
    kani::cover!(
        probability > 0.0 && sum == at_most,
        "a part that is rounded away"
    );
    assert!(does_not_fall(at_most, sum));
}

/// The threshold of a sum that does not fall does not fall, and is at most 2^32.
#[cfg_attr(kani, kani::proof)]
pub fn thresholds_rise_with_their_sum() {
    let (low, high): (f64, f64) = (kani::any(), kani::any());
    kani::assume(!(low < 0.0) && does_not_fall(low, high));
    let (below, above) = (threshold_of(low), threshold_of(high));
    kani::cover!(below < above && above < 1 << 32, "two thresholds");
    kani::cover!(low < high && below == above, "one threshold");
    assert!(below <= above && above <= 1 << 32);
}

/// The ranks of a sample lie apart and below the size of the footprint.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(10))]
#[cfg_attr(
    kani,
    kani::stub(crate::words::rng::block, crate::proofs::stubs::any_block)
)]
pub fn sampled_ranks_lie_apart() {
    let size = between(0, 12) as u32;
    let count = between(0, ALARMS_MAX as u64) as u32;
    let (ranks, taken) = sample(kani::any(), kani::any(), kani::any(), count, size);
    kani::cover!(count > size, "more alarms than cells");
    kani::cover!(taken == 2 && ranks[1] == size - 1, "the last cell");
    assert!(taken as u32 == if count < size { count } else { size });
    for k in 0..taken {
        assert!(ranks[k] < size);
        for other in 0..k {
            assert!(ranks[k] != ranks[other]);
        }
    }
}

/// Each rank below the size of a footprint names a cell of the grid within its radius, and two
/// ranks name two cells. Cell and radius are constants of each call, so that Kani's loops end and
/// no product is symbolic.
fn a_rank_names_a_cell(x: u32, y: u32, squared: u32) -> u32 {
    let (own, disc) = (Cell { x, y }, Disc::from_squared(squared));
    let size = disc.size(own, SIDE, SIDE);
    assert!(size >= 1 && size <= disc.size_max(SIDE, SIDE));
    let rank = between(0, u64::from(size) - 1) as u32;
    let other = between(0, u64::from(size) - 1) as u32;
    let cell = disc.ranked(rank, own, SIDE, SIDE);
    let (dx, dy) = (cell.x.abs_diff(own.x), cell.y.abs_diff(own.y));
    assert!(cell.x < SIDE && cell.y < SIDE);
    assert!([0, 1, 4][dx as usize] + [0, 1, 4][dy as usize] <= squared);
    let second = disc.ranked(other, own, SIDE, SIDE);
    assert!((rank == other) == (cell == second));
    size
}

/// The same around each cell; returns the size of the footprint in the middle.
fn a_rank_names_a_cell_within(squared: u32) -> u32 {
    a_rank_names_a_cell(0, 0, squared);
    a_rank_names_a_cell(1, 0, squared);
    a_rank_names_a_cell(2, 0, squared);
    a_rank_names_a_cell(0, 1, squared);
    a_rank_names_a_cell(2, 1, squared);
    a_rank_names_a_cell(0, 2, squared);
    a_rank_names_a_cell(1, 2, squared);
    a_rank_names_a_cell(2, 2, squared);
    a_rank_names_a_cell(1, 1, squared)
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(6))]
pub fn a_rank_names_a_cell_of_the_footprint() {
    let smallest = a_rank_names_a_cell_within(0);
    kani::cover!(smallest == 1, "its own cell alone");
    a_rank_names_a_cell_within(1);
    a_rank_names_a_cell_within(2);
    a_rank_names_a_cell_within(3);
    a_rank_names_a_cell_within(4);
    a_rank_names_a_cell_within(5);
    a_rank_names_a_cell_within(6);
    a_rank_names_a_cell_within(7);
    let largest = a_rank_names_a_cell_within(8);
    kani::cover!(largest == SIDE * SIDE, "the whole grid");
}

/// A set of false confirmations only grows, by the cells that a quorum sees, and the count of the
/// step is how many joined it.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(5))]
pub fn a_false_confirmation_is_never_taken_back() {
    let (alarms, quorum) = ([0; 4].map(|_: u64| between(0, 3)), between(1, 3));
    let before = between(0, 7);
    let (mut confirmed, mut counts) = ([before], kani::any::<[u64; 3]>());
    let fresh = crate::rules::alarms::confirm_cells(&alarms, quorum, &mut confirmed, &mut counts);
    kani::cover!(fresh == 2, "two cells");
    kani::cover!(fresh == 0 && before == 7, "nothing is left to confirm");
    assert!(confirmed[0] & before == before);
    assert!(fresh == u64::from((confirmed[0] & !before).count_ones()));
    let cell = between(0, 2);
    let mut seen = 0;
    for alarm in alarms {
        seen += u64::from(alarm == cell + 1);
    }
    let joins = confirmed[0] >> cell & 1 == 1;
    assert!(joins == (before >> cell & 1 == 1 || seen >= quorum));
}

/// Where UAVs keep their false alarms, a cell joins the set exactly if an alarm names it and a
/// quorum keeps it.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
pub fn a_kept_false_alarm_counts_once() {
    let (alarms, quorum) = ([0; 3].map(|_: u64| between(0, 3)), between(1, 3));
    let (before, kept) = (between(0, 7), [0; 3].map(|_: u64| between(0, 7)));
    let mut confirmed = [before];
    let fresh = crate::rules::alarms::confirm_kept(&alarms, &kept, quorum, &mut confirmed);
    kani::cover!(fresh == 2, "two cells");
    kani::cover!(
        alarms[0] == 1 && alarms[1] == 1 && fresh == 1,
        "two alarms in one cell"
    );
    assert!(confirmed[0] & before == before);
    assert!(fresh == u64::from((confirmed[0] & !before).count_ones()));
    let cell = between(0, 2);
    let (mut seen, mut named) = (0, false);
    for k in 0..3 {
        seen += kept[k] >> cell & 1;
        named |= alarms[k] == cell + 1;
    }
    let joins = confirmed[0] >> cell & 1 == 1;
    assert!(joins == (before >> cell & 1 == 1 || named && seen >= quorum));
}

#[cfg(not(kani))]
super::standin::twins! {
    a_probability_is_not_negative: 4000 cases, 2 covers;
    a_sum_is_not_below_its_part: 4000 cases, 1 covers;
    thresholds_rise_with_their_sum: 4000 cases, 2 covers;
    thresholds_rise_within_the_draws: 4000 cases, 2 covers;
    sampled_ranks_lie_apart: 4000 cases, 2 covers;
    a_rank_names_a_cell_of_the_footprint: 4000 cases, 2 covers;
    a_false_confirmation_is_never_taken_back: 4000 cases, 2 covers;
    a_kept_false_alarm_counts_once: 4000 cases, 2 covers;
}

/// The real functions on dense grids of what the stubs assume.
#[cfg(test)]
mod dense {
    use super::super::tables::{EXP_MAX, EXP_MIN};

    #[test]
    fn exp_and_log1p_stay_within_their_stubs() {
        for step in 0..=700_000 {
            let value = libm::exp(f64::from(-step) / 1000.0);
            assert!((EXP_MIN..=EXP_MAX.min(1.0)).contains(&value), "{step}");
        }
        for step in 0..=500_000 {
            let value = libm::log1p(-f64::from(step) / 1e6);
            assert!((-0.7..=0.0).contains(&value), "{step}: {value}");
        }
    }
}
