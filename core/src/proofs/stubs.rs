//! What stands for a function in a proof that does not look into it: any value that the function's
//! own proof, or its documentation, allows. Each is a row of `verification/ASSUMPTIONS.md`.
//!
//! A stub asserts what its function's proof assumes of the arguments.

// Named in attributes alone, which the compiler does not count as a use.
#![allow(dead_code)]

use super::carbon::{FLEET_NG, FLEET_UJ, INTENSITY_MG_PER_KWH};
use super::curves::{
    FALSE_ALARM_EXPONENT_MAX, INVERSE_PROBABILITY_MAX, LOG_MAX, LOG_PROBABILITY_MIN, UAV_ODDS_MAX,
    UAV_ODDS_MIN,
};
use super::inputs::{between, does_not_fall, real_between};
use super::reward::REWARD_MAX;
use super::state::{links_join_two, radios_are_valid};
use super::tables::{EXP_MAX, EXP_MIN, LOAD_ODDS_MAX, LOG2_MAX, LOG10_MAX, ODDS_MAX, ODDS_MIN};
use crate::constants::energy::{Activity, EnergyConstants};
use crate::constants::reward::{COMPONENTS, RewardConstants, Rewards};
use crate::model::Model;
use crate::state::StateMut;
use crate::state::scratch::Scratch;
use crate::state::scratch::StepTotals;
use crate::words::rng::Purpose;

pub(super) fn any_block(_: u64, _: u32, _: u32, _: u32, _: Purpose) -> [u32; 4] {
    kani::any()
}

/// `bits::set_range` for rows of one word, without a loop and without an index.
pub(super) fn set_range_of_a_word(row: &mut [u64], begin: usize, end: usize) {
    assert!(row.len() == 1 && begin <= end && end < 64);
    row[0] |= ((1 << end) - 1) & !((1 << begin) - 1);
}

/// What `action::pilot_density_stays_in_range` shows.
pub(super) fn any_pilot_density(u_pilot: f32, min: f64, max: f64) -> f64 {
    assert!(!u_pilot.is_nan() && min >= 0.0 && min <= max && max <= 1.0);
    real_between(min, max)
}

pub(super) fn any_exp(x: f64) -> f64 {
    assert!(x >= -700.0 && x <= 700.0);
    real_between(EXP_MIN, EXP_MAX)
}

pub(super) fn any_odds_exp(x: f64) -> f64 {
    assert!(x >= -300.0 && x <= 300.0);
    real_between(ODDS_MIN, ODDS_MAX)
}

pub(super) fn any_uav_exp(x: f64) -> f64 {
    assert!(x >= -380.0 && x <= 380.0);
    real_between(UAV_ODDS_MIN, UAV_ODDS_MAX)
}

pub(super) fn any_alarm_exp(x: f64) -> f64 {
    assert!(x >= -700.0 && x <= 0.0);
    real_between(EXP_MIN, 1.0)
}

/// What `alarms::a_probability_is_not_negative` shows.
pub(super) fn any_next(k: f64, all: f64, odds: f64, probability: f64) -> f64 {
    assert!(all > k && odds >= 0.0 && !(probability < 0.0));
    let following: f64 = kani::any();
    kani::assume(!(following < 0.0));
    following
}

/// What `alarms::a_sum_is_not_below_its_part` shows.
pub(super) fn any_sum(at_most: f64, probability: f64) -> f64 {
    assert!(!(at_most < 0.0) && !(probability < 0.0));
    let sum: f64 = kani::any();
    kani::assume(does_not_fall(at_most, sum));
    sum
}

pub(super) fn any_log1p(x: f64) -> f64 {
    assert!(x >= -0.5 && x <= 0.0);
    real_between(-0.7, 0.0)
}

pub(super) fn any_log(x: f64) -> f64 {
    assert!(x >= 1e-30 && x <= 1e4);
    real_between(-LOG_MAX, LOG_MAX)
}

pub(super) fn any_log_probability(x: f64) -> f64 {
    assert!(x >= 5e-324 && x <= 1.0);
    real_between(LOG_PROBABILITY_MIN, 0.0)
}

pub(super) fn any_real_exp(x: f64) -> f64 {
    assert!(x >= 0.0 && x <= FALSE_ALARM_EXPONENT_MAX);
    real_between(1.0, INVERSE_PROBABILITY_MAX)
}

pub(super) fn any_log10(x: f64) -> f64 {
    assert!(x >= 1e-12 && x <= 1e18);
    real_between(-LOG10_MAX, LOG10_MAX)
}

pub(super) fn any_log2(x: f64) -> f64 {
    assert!(x >= 1.0);
    real_between(0.0, LOG2_MAX)
}

pub(super) fn any_load_odds(_: f64, _: f64) -> f64 {
    real_between(1.0, LOAD_ODDS_MAX)
}

pub(super) fn any_detects(_: u32, _: f64) -> bool {
    kani::any()
}

/// Any charge of a battery, empty and full among them.
pub(super) fn any_charge(model: &Model<'_>, _: u64, _: usize) -> u64 {
    between(0, model.energy().capacity_uj)
}

pub(super) fn any_mean_throughput(load: f64, sum: f64, degree: u32) -> f64 {
    assert!(load >= 0.0 && load <= 1.0 && sum >= 0.0 && sum <= 1e6);
    assert!(degree <= 1);
    if degree == 0 {
        0.0
    } else {
        real_between(0.0, 1e6)
    }
}

/// A relation that tells any two sets of arguments apart in some state, and does not mind the order
/// of the two loads.
pub(super) fn any_symmetric_relation(a: f64, b: f64, full_throughput: f64, _: f64) -> bool {
    (a.to_bits() ^ b.to_bits() ^ full_throughput.to_bits()).count_ones() % 2 == 1
}

/// The same, but never true of what is not a number, so that no UAV is its own neighbour.
pub(super) fn any_hearing(a: f64, b: f64, full_throughput: f64, least: f64) -> bool {
    !full_throughput.is_nan() && any_symmetric_relation(a, b, full_throughput, least)
}

/// Any graph of the smallest model that `communication::building_the_graph_keeps_its_contract`
/// allows.
pub(super) fn any_graph(model: &Model<'_>, state: &mut StateMut<'_>, _: &mut Scratch<'_>) {
    assert!(radios_are_valid(model, &state.as_ref()));
    let linked: bool = kani::any();
    let both_fly = state.grounded[0] == 0;
    state.links[0] = if linked && both_fly { 2 } else { 0 };
    state.links[1] = if linked && both_fly { 1 } else { 0 };
    state.set_throughput(0, real_between(0.0, 1e6));
    state.set_throughput(1, real_between(0.0, 1e6));
    state.header.set_mean_throughput(real_between(0.0, 1e6));
}

/// What `communication::measuring_the_throughput_keeps_its_contract` allows.
pub(super) fn any_measured_throughput(model: &Model<'_>, state: &mut StateMut<'_>) {
    assert!(radios_are_valid(model, &state.as_ref()));
    assert!(links_join_two(model, &state.as_ref()));
    state.set_throughput(0, real_between(0.0, 1e6));
    state.set_throughput(1, real_between(0.0, 1e6));
    state.header.set_mean_throughput(real_between(0.0, 1e6));
}

pub(super) fn any_potentials(
    _: &Model<'_>,
    state: &mut StateMut<'_>,
    _: &mut Scratch<'_>,
    terminal: bool,
) {
    let goal = || {
        let potential = real_between(-2.0, 0.0);
        if terminal { 0.0 } else { potential }
    };
    let charge = || {
        let potential = real_between(0.0, 0.1);
        if terminal { 0.0 } else { potential }
    };
    state.set_goal_potential(0, goal());
    state.set_goal_potential(1, goal());
    state.set_charge_potential(0, charge());
    state.set_charge_potential(1, charge());
    state.header.set_goal_potential(goal());
    state.header.set_charge_potential(charge());
}

pub(super) fn any_rewards(_: &RewardConstants, _: &StepTotals) -> Rewards {
    let mut rewards = [0.0; COMPONENTS];
    for index in 0..rewards.len() {
        rewards[index] = real_between(-REWARD_MAX, REWARD_MAX);
    }
    rewards
}

pub(super) fn any_total(_: &Rewards) -> f64 {
    real_between(-REWARD_MAX, REWARD_MAX) + 0.0
}

pub(super) fn any_asked(plan: &EnergyConstants, activity: Activity, density: f64) -> u64 {
    assert!(density >= 0.0 && density <= 1.0);
    if activity.flies == 0 {
        0
    } else {
        between(0, plan.most_asked_uj())
    }
}

pub(super) fn any_emission(grid_uj: u64, intensity_mg_per_kwh: u64) -> u64 {
    assert!(grid_uj <= FLEET_UJ && intensity_mg_per_kwh <= INTENSITY_MG_PER_KWH);
    if grid_uj == FLEET_UJ && intensity_mg_per_kwh == INTENSITY_MG_PER_KWH {
        FLEET_NG
    } else {
        between(0, FLEET_NG)
    }
}

pub(super) fn any_share(co2_ng: u64, billed_uj: u64, billed_fleet_uj: u64) -> f64 {
    assert!(co2_ng <= FLEET_NG && billed_uj <= billed_fleet_uj);
    real_between(0.0, FLEET_NG as f64)
}

/// The checksum of nothing.
pub(super) fn skip_bytes(_: &mut crate::words::hash::Fnv1a, _: &[u8]) {}

/// The checksum of nothing.
pub(super) fn skip_word(_: &mut crate::words::hash::Fnv1a, _: u64) {}

/// Keeps the last eight bytes in place of the product: what any two writers of the same bytes leave
/// is the same.
pub(super) fn keep_bytes(hash: &mut crate::words::hash::Fnv1a, bytes: &[u8]) {
    for index in 0..bytes.len() {
        let kept = hash.finish() << 8 | u64::from(bytes[index]);
        *hash = crate::words::hash::Fnv1a::resumed(kept);
    }
}
