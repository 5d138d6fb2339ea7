//! P14: a step's reward is finite and bounded.

use super::inputs::{between, real_between};
#[cfg(not(kani))]
use super::standin as kani;
use crate::config::Config;
use crate::reward::{Happenings, RewardPlan, total};
use crate::validity::THROUGHPUT_MAX;

/// What the default weights can pay or take in a step of any legal size, at most half of it for the
/// highest throughput that a host can give.
pub(super) const REWARD_MAX: f64 = 1e9;

/// Whatever happened within the legal sizes. Potentials lie in [-w, w] of their weights.
fn any_happenings() -> Happenings {
    Happenings {
        newly_confirmed: between(0, 4096),
        newly_informed: between(0, 4096),
        informed: between(0, 4096),
        complete: kani::any(),
        at_horizon: kani::any(),
        new_cells: between(0, 4096),
        revisits: between(0, 4096),
        spent_uj: between(0, 1 << 62),
        co2_ng: between(0, 1 << 62),
        mean_throughput: real_between(0.0, THROUGHPUT_MAX),
        knowledge_spread: real_between(0.0, 1.0),
        goal_potential_before: real_between(-1.0, 0.0),
        goal_potential_after: real_between(-1.0, 0.0),
        charge_potential_before: real_between(0.0, 0.1),
        charge_potential_after: real_between(0.0, 0.1),
    }
}

/// Every component is a finite number, and so is their sum, within the bound.
fn is_bounded(plan: &RewardPlan, step: &Happenings) {
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
    let plan = RewardPlan::new(&Config::default());
    let step = any_happenings();
    kani::cover!(
        step.complete && step.newly_informed > 0,
        "the mission is completed"
    );
    kani::cover!(step.at_horizon && !step.complete, "the horizon ends it");
    is_bounded(&plan, &step);
}

#[cfg(not(kani))]
super::standin::twins! {
    rewards_are_bounded: 4000 cases, 2 covers;
}
