//! P14: a step's reward is finite and bounded.

use super::inputs::{between, real_between};
#[cfg(not(kani))]
use super::standin as kani;
use crate::config::Config;
use crate::rules::carbon;
use crate::rules::reward::{RewardConstants, StepTotals, total};
use crate::state::validity::THROUGHPUT_MAX;

/// Bound of the reward of a step of any legal size with the default weights. At most half of it is
/// for the highest throughput that a host can give.
pub(super) const REWARD_MAX: f64 = 1e9;

/// The goal potential counts up to 4096 unconfirmed hotspots beside the distance to one.
const GOAL_MIN: f64 = -4097.0;

/// Any totals of a step within the legal sizes. Potentials lie within their weights.
fn any_totals() -> StepTotals {
    StepTotals {
        newly_confirmed: between(0, 4096),
        newly_false: between(0, 4096),
        newly_informed: between(0, 4096),
        informed: between(0, 4096),
        confirmed: between(0, 4096),
        complete: kani::any(),
        at_horizon: kani::any(),
        new_cells: between(0, 4096),
        revisits: between(0, 4096),
        spent_uj: between(0, 1 << 62),
        co2_ng: real_between(0.0, 4_611_686_018_427_387_904.0),
        mean_throughput: real_between(0.0, THROUGHPUT_MAX),
        knowledge_spread: real_between(0.0, 1.0),
        goal_potential_before: real_between(GOAL_MIN, 0.0),
        goal_potential_after: real_between(GOAL_MIN, 0.0),
        charge_potential_before: real_between(0.0, 0.1),
        charge_potential_after: real_between(0.0, 0.1),
    }
}

/// Every component is a finite number, and so is their sum, within the bound.
fn is_bounded(plan: &RewardConstants, step: &StepTotals) {
    let rewards = plan.components(step);
    for index in 0..rewards.len() {
        assert!(rewards[index] >= -REWARD_MAX && rewards[index] <= REWARD_MAX);
    }
    let sum = total(&rewards);
    assert!(sum >= -REWARD_MAX && sum <= REWARD_MAX);
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(13))]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn rewards_are_bounded() {
    let plan = RewardConstants::new(&Config::default());
    let step = any_totals();
    kani::cover!(
        step.complete && step.newly_informed > 0,
        "the mission is completed"
    );
    kani::cover!(step.at_horizon && !step.complete, "the horizon ends it");
    is_bounded(&plan, &step);
}

/// A UAV's own terms are bounded for any totals in a fleet of any legal size.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(13))]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn a_uavs_own_components_are_bounded() {
    let plan = RewardConstants::new(&Config::default());
    let (new_cells, spent_uj) = (between(0, 4096) as f64, between(0, 1 << 62) as f64);
    let (revisits, throughput) = (between(0, 4096) as f64, real_between(0.0, THROUGHPUT_MAX));
    let co2_ng = real_between(0.0, 4_611_686_018_427_387_904.0);
    let (before, after) = (real_between(GOAL_MIN, 0.1), real_between(GOAL_MIN, 0.1));
    kani::cover!(new_cells > 0.0 && revisits == 0.0, "a cell is discovered");
    kani::cover!(spent_uj == 0.0 && co2_ng > 0.0, "a charging UAV");
    let own = [
        plan.coverage(new_cells),
        plan.energy(spent_uj),
        plan.carbon(co2_ng),
        plan.revisit(revisits),
        plan.throughput(throughput),
        plan.shaping(before, after),
    ];
    for index in 0..own.len() {
        assert!(own[index] >= -REWARD_MAX && own[index] <= REWARD_MAX);
    }
}

#[cfg_attr(kani, kani::proof)]
pub fn a_share_of_carbon_is_within_the_whole() {
    let whole = between(0, 1 << 62);
    let billed_fleet_uj = between(0, 1 << 50);
    let billed_uj = between(0, billed_fleet_uj);
    let share = carbon::share_ng(whole, billed_uj, billed_fleet_uj);
    kani::cover!(billed_fleet_uj == 0, "nothing is billed");
    kani::cover!(share > 0.0 && billed_uj < billed_fleet_uj, "a part of it");
    assert!(share >= 0.0 && share <= whole as f64);
}

#[cfg(not(kani))]
super::standin::twins! {
    rewards_are_bounded: 4000 cases, 2 covers;
    a_uavs_own_components_are_bounded: 4000 cases, 2 covers;
    a_share_of_carbon_is_within_the_whole: 4000 cases, 2 covers;
}
