//! P14: a step's reward is finite and bounded.

use super::inputs::{between, real_between};
#[cfg(not(kani))]
use super::standin as kani;
use crate::carbon;
use crate::config::Config;
use crate::reward::{COMPONENTS, Deeds, Happenings, OWN, RewardPlan, total};
use crate::validity::THROUGHPUT_MAX;

/// What the default weights can pay or take in a step of any legal size, at most half of it for the
/// highest throughput that a host can give.
pub(super) const REWARD_MAX: f64 = 1e9;

/// The goal potential counts up to 4096 unconfirmed hotspots beside the distance to one.
const GOAL_MIN: f64 = -4097.0;

/// Whatever happened within the legal sizes. Potentials lie within their weights.
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

/// Whatever one UAV did: `uavs` times its energy and its carbon stay below 2^62.
fn any_deeds() -> Deeds {
    Deeds {
        new_cell: kani::any(),
        revisit: kani::any(),
        spent_uj: between(0, 1 << 50),
        co2_ng: real_between(0.0, 1_125_899_906_842_624.0),
        throughput: real_between(0.0, THROUGHPUT_MAX),
        goal_potential_before: real_between(GOAL_MIN, 0.0),
        goal_potential_after: real_between(GOAL_MIN, 0.0),
        charge_potential_before: real_between(0.0, 0.1),
        charge_potential_after: real_between(0.0, 0.1),
    }
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(13))]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn a_uavs_reward_is_bounded_and_shares_the_teams_terms() {
    let plan = RewardPlan::new(&Config::default());
    let (step, own) = (any_happenings(), any_deeds());
    let credited = step.credited(between(1, 4096), &own);
    kani::cover!(own.new_cell && !own.revisit, "a cell is discovered");
    kani::cover!(own.spent_uj == 0 && own.co2_ng > 0.0, "a charging UAV");
    // Where `rewards_are_bounded` draws from.
    assert!(credited.new_cells <= 4096 && credited.revisits <= 4096);
    assert!(credited.spent_uj <= 1 << 62);
    assert!(credited.co2_ng >= 0.0 && credited.co2_ng <= 4_611_686_018_427_387_904.0);
    assert!(credited.mean_throughput >= 0.0 && credited.mean_throughput <= THROUGHPUT_MAX);
    for goal in [
        credited.goal_potential_before,
        credited.goal_potential_after,
    ] {
        assert!(goal >= GOAL_MIN && goal <= 0.0);
    }
    for charge in [
        credited.charge_potential_before,
        credited.charge_potential_after,
    ] {
        assert!(charge >= 0.0 && charge <= 0.1);
    }
    shares_what_the_teams_terms_read(&step, &credited);
    if !cfg!(kani) {
        is_bounded(&plan, &credited);
        let (team, rewards) = (plan.components(&step), plan.components(&credited));
        for index in 0..COMPONENTS {
            let own = OWN.contains(&index);
            assert!(own || rewards[index].to_bits() == team[index].to_bits());
        }
    }
}

/// The quantities that the terms outside `OWN` are made of. That no other is read by them is tested: a solver
/// does not see that two equal products of reals are equal.
fn shares_what_the_teams_terms_read(step: &Happenings, credited: &Happenings) {
    assert!(credited.newly_confirmed == step.newly_confirmed);
    assert!(credited.newly_informed == step.newly_informed && credited.informed == step.informed);
    assert!(credited.complete == step.complete && credited.at_horizon == step.at_horizon);
    assert!(credited.knowledge_spread.to_bits() == step.knowledge_spread.to_bits());
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
    a_uavs_reward_is_bounded_and_shares_the_teams_terms: 4000 cases, 2 covers;
    a_share_of_carbon_is_within_the_whole: 4000 cases, 2 covers;
}
