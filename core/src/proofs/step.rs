//! P10, the inductive steps: each part of a step keeps a valid state valid, for any state and any
//! actions. The base case is in `reset`, and communication is in `communication`. The same
//! harnesses show P6 and P8.

use super::inputs::{between, real_between};
#[cfg(not(kani))]
use super::standin as kani;
use super::state::{
    REMEMBERING_WORDS, STATE_WORDS, any_actions, any_fleet, any_fleet_in, any_phase, any_state,
    carries_mean_throughput, carries_scalars, changes_before_the_end, confirms_by_quorum,
    nothing_is_forgotten, open, view,
};
use crate::constants::reward::OWN_KEPT;
use crate::model::Model;
use crate::model::any_model::HOTSPOTS_MAX;
use crate::rules::sensing::{confirm_and_learn, look_around};
use crate::state::StateRef;
use crate::state::header::{self, Phase};
use crate::state::validity::THROUGHPUT_MAX;
use crate::words::bits;

/// Actions, return to base, move; time goes on by one and never past the horizon.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(5))]
pub fn beginning_a_step_keeps_the_state_valid() {
    given!(model);
    let before = any_fleet(&model, Phase::Ready);
    let mut after = before;
    let actions = any_actions();
    let done = model.step_begin(
        &mut open(&model, &mut after),
        &actions[..model.action_len()],
    );
    assert!(done.is_ok());
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(new.grounded(0), "a grounded UAV");
    kani::cover!(new.returning(0) && new.moved(0), "a UAV on its way home");
    kani::cover!(new.t() == model.config().horizon_steps, "the last step");
    assert!(new.t() == old.t() + 1 && new.t() <= model.config().horizon_steps);
    for i in 0..model.uav_count() {
        assert!(!(new.grounded(i) && new.moved(i)));
    }
    carries_scalars(&old, &new);
    assert!(new.header.phase() == Some(Phase::Moved));
    assert!(new.fleet_is_valid(&model, Phase::Moved));
}

/// Sense and learn.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
#[cfg_attr(
    kani,
    kani::stub(crate::words::rng::block, crate::proofs::stubs::any_block)
)]
#[cfg_attr(
    kani,
    kani::stub(
        crate::radio::radar::load_odds_against,
        crate::proofs::stubs::any_load_odds
    )
)]
#[cfg_attr(
    kani,
    kani::stub(crate::radio::radar::detects, crate::proofs::stubs::any_detects)
)]
pub fn sensing_keeps_the_state_valid() {
    given!(model);
    let before = any_fleet(&model, Phase::Moved);
    let mut after = before;
    given!(scratch for model);
    let done = model.step_sense(&mut open(&model, &mut after), &mut scratch);
    assert!(done.is_ok());
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(!old.confirmed(0) && new.confirmed(0), "a confirmation");
    kani::cover!(!old.knows(0, 0) && new.knows(0, 0), "a UAV learns");
    kani::cover!(!new.confirmed(0), "no confirmation");
    nothing_is_forgotten(&model, &old, &new);
    confirms_by_quorum(&model, &old, &new);
    carries_scalars(&old, &new);
    assert!(new.header.phase() == Some(Phase::Sensed));
    assert!(new.fleet_is_valid(&model, Phase::Sensed));
}

/// Any detections, where the quorum counts the episode and a UAV learns all that it detects.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
pub fn learning_with_memory_keeps_the_state_valid() {
    given!(model = any_remembering_model);
    let mut before: [u64; REMEMBERING_WORDS] = any_fleet_in(&model, Phase::Moved);
    for row in open(&model, &mut before).detected {
        *row = between(0, bits::valid_mask(0, model.hotspot_count()));
    }
    let mut after = before;
    let mut positives = [0; HOTSPOTS_MAX];
    let positives = &mut positives[..model.hotspot_count()];
    look_around(&model, &mut open(&model, &mut after));
    confirm_and_learn(&model, &mut open(&model, &mut after), positives);
    after[header::PHASE] = Phase::Sensed as u64;
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(
        !old.confirmed(0) && new.confirmed(0) && !new.detected(0, 0),
        "a detection of an earlier step confirms"
    );
    kani::cover!(
        new.knows(0, 0) && !new.confirmed(0),
        "a UAV knows a hotspot that is not confirmed"
    );
    nothing_is_forgotten(&model, &old, &new);
    confirms_by_quorum(&model, &old, &new);
    learns_all_detections(&model, &old, &new);
    assert!(new.fleet_is_valid(&model, Phase::Sensed));
}

/// Each UAV remembers and knows what it did before, and what it detects.
fn learns_all_detections(model: &Model<'_>, old: &StateRef<'_>, new: &StateRef<'_>) {
    for j in 0..model.hotspot_count() {
        for i in 0..model.uav_count() {
            let now = old.detected(i, j);
            assert!(new.remembered(i, j) == (old.remembered(i, j) || now));
            assert!(new.knows(i, j) == (old.knows(i, j) || now));
        }
    }
}

/// Any words whose scalars are valid.
#[cfg(kani)]
fn any_scalars(model: &Model<'_>) -> [u64; STATE_WORDS] {
    let words: [u64; STATE_WORDS] = kani::any();
    // A valid fleet's: `is_valid` judges time before the scalars.
    kani::assume(words[header::T] <= u64::from(model.config().horizon_steps));
    kani::assume(view(model, &words).scalars_are_valid(model));
    words
}

/// A state of any phase.
#[cfg(not(kani))]
fn any_scalars(model: &Model<'_>) -> [u64; STATE_WORDS] {
    any_state(model, any_phase())
}

/// A part that carries the scalars keeps them valid.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(17))]
pub fn carried_scalars_stay_valid() {
    given!(model);
    let before = any_scalars(&model);
    let mut after: [u64; STATE_WORDS] = kani::any();
    for index in 0..header::WORDS {
        if !changes_before_the_end(index) {
            after[index] = before[index];
        }
    }
    // Rewards and potentials of UAVs follow the nine quantities that each has.
    let begin = header::WORDS + 9 * model.uav_count();
    for index in begin..begin + (2 + OWN_KEPT) * model.uav_count() {
        after[index] = before[index];
    }
    let phase = any_phase();
    after[header::PHASE] = phase as u64;
    after[header::T] = between(0, u64::from(model.config().horizon_steps));
    after[header::MEAN_THROUGHPUT] = if kani::any() {
        before[header::MEAN_THROUGHPUT]
    } else {
        real_between(0.0, THROUGHPUT_MAX).to_bits()
    };
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::assume(old.settled_steps() == new.settled_steps());
    kani::assume(carries_mean_throughput(&old, &new));
    kani::cover!(old.t() != new.t(), "a step begins");
    assert!(new.scalars_are_valid(&model));
}

/// Energy, charge, carbon, reward, termination: ledgers grow, and the episode ends at the horizon.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(13))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(
    kani,
    kani::stub(crate::words::rng::block, crate::proofs::stubs::any_block)
)]
#[cfg_attr(
    kani,
    kani::stub(crate::rules::potential::update, crate::proofs::stubs::any_potentials)
)]
#[cfg_attr(
    kani,
    kani::stub(
        crate::rules::reward::RewardConstants::components,
        crate::proofs::stubs::any_rewards
    )
)]
#[cfg_attr(
    kani,
    kani::stub(crate::constants::reward::total, crate::proofs::stubs::any_total)
)]
#[cfg_attr(
    kani,
    kani::stub(
        crate::constants::energy::EnergyConstants::asked_uj,
        crate::proofs::stubs::any_asked
    )
)]
#[cfg_attr(
    kani,
    kani::stub(
        crate::constants::carbon::emitted_ng,
        crate::proofs::stubs::any_emission
    )
)]
#[cfg_attr(
    kani,
    kani::stub(crate::rules::carbon::share_ng, crate::proofs::stubs::any_share)
)]
#[cfg_attr(kani, kani::stub_verified(crate::rules::energy::settle))]
pub fn ending_a_step_keeps_the_state_valid() {
    given!(model);
    let before = any_state(&model, Phase::Communicated);
    let mut after = before;
    given!(scratch for model);
    let done = model.step_end(&mut open(&model, &mut after), &mut scratch);
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(new.terminated(), "the mission ends");
    kani::cover!(new.truncated(), "the horizon ends it");
    kani::cover!(new.battery_uj(0) < old.battery_uj(0), "a battery is used");
    assert!(done.is_ok_and(|outcome| outcome.reward.is_finite()));
    assert!(new.co2_ng() >= old.co2_ng() && new.grid_uj() >= old.grid_uj());
    assert!(new.spent_uj(0) >= old.spent_uj(0) && new.accepted_uj(0) >= old.accepted_uj(0));
    assert!(new.t() < model.config().horizon_steps || new.terminated() || new.truncated());
    assert!(!(new.terminated() && new.truncated()));
    assert!(new.is_valid(&model));
}

#[cfg(not(kani))]
super::standin::twins! {
    beginning_a_step_keeps_the_state_valid: 2000 cases, 3 covers;
    sensing_keeps_the_state_valid: 2000 cases, 3 covers;
    learning_with_memory_keeps_the_state_valid: 2000 cases, 2 covers;
    carried_scalars_stay_valid: 2000 cases, 1 covers;
    ending_a_step_keeps_the_state_valid: 2000 cases, 3 covers;
}

#[cfg(test)]
mod sizes {
    use super::super::state::{
        SMALLEST_REMEMBERING_WORDS, SMALLEST_SCRATCH_WORDS, SMALLEST_SPREAD_SCRATCH_WORDS,
        SMALLEST_SPREAD_WORDS, SMALLEST_STATE_WORDS,
    };
    use crate::config::Config;
    use crate::constants::layout::Layout;
    use crate::lanes;
    use crate::model::Model;
    use crate::model::any_model::{SMALLEST_TABLE_WORDS, remembering, smallest};
    use crate::rules::reward::{COMPONENTS, OWN_COMPONENTS};
    use crate::state::scratch::Scratch;

    /// Words of a state in which each reward has one component.
    fn words_seen_by_kani(config: &Config) -> usize {
        let own = config.uav_count as usize * (OWN_COMPONENTS - 1);
        Layout::of(config).end - (COMPONENTS - 1) - own
    }

    fn scratch_words_seen_by_kani(config: Config) -> usize {
        let mut tables = [0; SMALLEST_TABLE_WORDS];
        let model = Model::new_in(config, &mut tables).unwrap();
        lanes::forced::at(2, || Scratch::words_for(&model))
    }

    /// Catches a change of the layout that Kani's fixed sizes do not follow.
    #[test]
    fn the_smallest_model_has_the_sizes_that_kani_is_given() {
        let spread = Config {
            hotspot_count: 2,
            ..smallest()
        };
        assert_eq!(words_seen_by_kani(&smallest()), SMALLEST_STATE_WORDS);
        assert_eq!(words_seen_by_kani(&spread), SMALLEST_SPREAD_WORDS);
        let words = words_seen_by_kani(&remembering(smallest()));
        assert_eq!(words, SMALLEST_REMEMBERING_WORDS);
        assert_eq!(Model::table_words(&smallest()), Ok(SMALLEST_TABLE_WORDS));
        assert_eq!(
            scratch_words_seen_by_kani(smallest()),
            SMALLEST_SCRATCH_WORDS
        );
        let words = scratch_words_seen_by_kani(spread);
        assert_eq!(words, SMALLEST_SPREAD_SCRATCH_WORDS);
    }
}
