//! P10, part by part: a reset makes a valid state, and each part of a step keeps it valid, whatever the
//! state and the actions. So every state that a run reaches is valid, by induction. P6 and P8 ride along.
//!
//! Stubs stand for what is shown or tested elsewhere: the generator gives any words, the UAV's radar
//! factor and the potentials any value in their range (`proofs::tables`, `dense`).

use super::inputs::between;
#[cfg(kani)]
use super::inputs::real_between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::error::Error;
use crate::header::Phase;
use crate::model::Model;
use crate::model::any_model::{TABLE_WORDS, any_model};
use crate::scratch::Scratch;
use crate::state::{StateMut, StateRef};

/// Words of a state of the smallest model.
const SMALLEST_STATE_WORDS: usize = 58;
/// Words of a state of any model that Kani sees.
#[cfg(kani)]
pub(super) const STATE_WORDS: usize = SMALLEST_STATE_WORDS;
/// Words of a state of any model that the stand-in makes.
#[cfg(not(kani))]
pub(super) const STATE_WORDS: usize = 128;
const SCRATCH_WORDS: usize = 32;
/// Two components for each UAV of the smallest model.
#[cfg(kani)]
const ACTIONS: usize = 4;
/// Two components for each of at most five UAVs.
#[cfg(not(kani))]
const ACTIONS: usize = 10;

pub(super) fn view<'a>(model: &Model<'_>, words: &'a [u64; STATE_WORDS]) -> StateRef<'a> {
    StateRef::split(*model.layout(), &words[..model.state_words()])
}

pub(super) fn open<'a>(model: &Model<'_>, words: &'a mut [u64; STATE_WORDS]) -> StateMut<'a> {
    StateMut::split(*model.layout(), &mut words[..model.state_words()])
}

/// Any state of the phase that is valid but perhaps for its scalars.
#[cfg(kani)]
pub(super) fn any_fleet(model: &Model<'_>, phase: Phase) -> [u64; STATE_WORDS] {
    let words: [u64; STATE_WORDS] = kani::any();
    let state = view(model, &words);
    kani::assume(state.header.phase() == Some(phase));
    kani::assume(state.header.config_hash() == model.config_hash());
    kani::assume(state.fleet_is_valid(model, phase));
    words
}

/// A state of the phase on a random flight.
#[cfg(not(kani))]
pub(super) fn any_fleet(model: &Model<'_>, phase: Phase) -> [u64; STATE_WORDS] {
    let mut words = [0; STATE_WORDS];
    let mut scratch = [0; SCRATCH_WORDS];
    let mut scratch = Scratch::new(model, &mut scratch).unwrap();
    let steps = between(0, u64::from(model.config().horizon_steps));
    model
        .reset(&mut words[..model.state_words()], &mut scratch, kani::any())
        .unwrap();
    let mut state = open(model, &mut words);
    for _ in 0..steps {
        if state.header.phase() != Some(Phase::Ready) || phase == Phase::Ready && kani::any() {
            break;
        }
        let actions = any_actions();
        model
            .step(&mut state, &mut scratch, &actions[..model.action_len()])
            .unwrap();
    }
    let last = state.header.phase() == Some(phase);
    kani::assume(last || state.header.phase() == Some(Phase::Ready));
    let actions = any_actions();
    if phase != Phase::Ready && !last {
        model
            .step_begin(&mut state, &actions[..model.action_len()])
            .unwrap();
    }
    if matches!(phase, Phase::Sensed | Phase::Communicated) {
        model.step_sense(&mut state, &mut scratch).unwrap();
    }
    if phase == Phase::Communicated {
        model.step_communicate(&mut state, &mut scratch).unwrap();
    }
    kani::assume(state.header.phase() == Some(phase));
    words
}

/// Any state of the phase that is valid.
pub(super) fn any_state(model: &Model<'_>, phase: Phase) -> [u64; STATE_WORDS] {
    let words = any_fleet(model, phase);
    kani::assume(view(model, &words).is_valid(model));
    words
}

/// Any actions that are numbers.
fn any_actions() -> [f32; ACTIONS] {
    let mut actions: [f32; ACTIONS] = kani::any();
    for action in &mut actions {
        if action.is_nan() {
            *action = 0.0;
        }
    }
    actions
}

/// Some word differs. Kani looks at any one of them, the stand-in at all.
#[cfg(kani)]
pub(super) fn differ(a: &[u64; STATE_WORDS], b: &[u64; STATE_WORDS]) -> bool {
    let index = between(0, STATE_WORDS as u64 - 1) as usize;
    a[index] != b[index]
}

/// Some word differs. Kani looks at any one of them, the stand-in at all.
#[cfg(not(kani))]
pub(super) fn differ(a: &[u64; STATE_WORDS], b: &[u64; STATE_WORDS]) -> bool {
    a != b
}

/// Nothing known, confirmed or informed before is so no longer.
fn nothing_is_forgotten(model: &Model<'_>, before: &StateRef<'_>, after: &StateRef<'_>) {
    for j in 0..model.hotspot_count() {
        assert!(!before.confirmed(j) || after.confirmed(j));
        assert!(!before.informed(j) || after.informed(j));
        for i in 0..model.uav_count() {
            assert!(!before.knows(i, j) || after.knows(i, j));
        }
    }
}

#[cfg(kani)]
fn any_block(_: u64, _: u32, _: u32, _: u32, _: crate::rng::Purpose) -> [u32; 4] {
    kani::any()
}

#[cfg(kani)]
fn any_load_odds(_: f64, _: f64) -> f64 {
    real_between(1.0, 1e87)
}

#[cfg(kani)]
fn any_threshold(_: f64) -> u64 {
    between(0, 1 << 32)
}

#[cfg(kani)]
fn any_graph(_: &Model<'_>, state: &mut StateMut<'_>, _: &mut Scratch<'_>) {
    let linked: bool = kani::any();
    let both_fly = state.grounded[0] == 0;
    state.links[0] = if linked && both_fly { 2 } else { 0 };
    state.links[1] = if linked && both_fly { 1 } else { 0 };
    state.set_throughput(0, real_between(0.0, 1e6));
    state.set_throughput(1, real_between(0.0, 1e6));
    state.header.set_mean_throughput(real_between(0.0, 1e6));
}

#[cfg(kani)]
fn any_potentials(_: &Model<'_>, state: &mut StateMut<'_>, _: &mut Scratch<'_>, terminal: bool) {
    let (goal, charge) = (real_between(-1.0, 0.0), real_between(0.0, 0.1));
    state
        .header
        .set_goal_potential(if terminal { 0.0 } else { goal });
    state
        .header
        .set_charge_potential(if terminal { 0.0 } else { charge });
}

#[cfg(kani)]
fn any_rewards(
    _: &crate::reward::RewardPlan,
    _: &crate::reward::Happenings,
) -> crate::reward::Rewards {
    let mut rewards = [0.0; crate::reward::COMPONENTS];
    for index in 0..rewards.len() {
        rewards[index] = real_between(-2e6, 2e6);
    }
    rewards
}

/// The base: whatever the memory held and whatever the seed.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(60))]
#[cfg_attr(kani, kani::stub(crate::rng::block, any_block))]
#[cfg_attr(kani, kani::stub(crate::link::build_graph, any_graph))]
#[cfg_attr(kani, kani::stub(crate::potential::update, any_potentials))]
pub fn reset_makes_a_valid_state() {
    let mut tables = [0; TABLE_WORDS];
    let model = any_model(&mut tables);
    let mut words: [u64; STATE_WORDS] = kani::any();
    let mut scratch: [u64; SCRATCH_WORDS] = kani::any();
    let mut scratch = Scratch::new(&model, &mut scratch).unwrap();
    let done = model.reset(&mut words[..model.state_words()], &mut scratch, kani::any());
    assert!(done.is_ok());
    let state = view(&model, &words);
    kani::cover!(
        state.hotspot_cell(0).x == 0,
        "a hotspot in the first column"
    );
    kani::cover!(state.battery_uj(0) > 0, "a charged battery");
    assert!(state.t() == 0 && state.header.phase() == Some(Phase::Ready));
    assert!(state.is_valid(&model));
}

/// Actions, return to base, move; time goes on by one and never past the horizon.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(5))]
pub fn beginning_a_step_keeps_the_state_valid() {
    let mut tables = [0; TABLE_WORDS];
    let model = any_model(&mut tables);
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
    assert!(!(new.grounded(0) && new.moved(0)));
    assert!(new.fleet_is_valid(&model, Phase::Moved));
}

/// Sense and learn.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
#[cfg_attr(kani, kani::stub(crate::rng::block, any_block))]
#[cfg_attr(kani, kani::stub(crate::radar::load_odds_against, any_load_odds))]
#[cfg_attr(kani, kani::stub(crate::radar::detection_threshold, any_threshold))]
pub fn sensing_keeps_the_state_valid() {
    let mut tables = [0; TABLE_WORDS];
    let model = any_model(&mut tables);
    let before = any_fleet(&model, Phase::Moved);
    let mut after = before;
    let mut scratch: [u64; SCRATCH_WORDS] = kani::any();
    let mut scratch = Scratch::new(&model, &mut scratch).unwrap();
    let done = model.step_sense(&mut open(&model, &mut after), &mut scratch);
    assert!(done.is_ok());
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(!old.confirmed(0) && new.confirmed(0), "a confirmation");
    kani::cover!(!old.knows(0, 0) && new.knows(0, 0), "a UAV learns");
    kani::cover!(!new.confirmed(0), "no confirmation");
    nothing_is_forgotten(&model, &old, &new);
    assert!(new.fleet_is_valid(&model, Phase::Sensed));
}

/// The graph and the consensus over it.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn communicating_keeps_the_state_valid() {
    let mut tables = [0; TABLE_WORDS];
    let model = any_model(&mut tables);
    let before = any_fleet(&model, Phase::Sensed);
    let mut after = before;
    let mut scratch: [u64; SCRATCH_WORDS] = kani::any();
    let mut scratch = Scratch::new(&model, &mut scratch).unwrap();
    let done = model.step_communicate(&mut open(&model, &mut after), &mut scratch);
    assert!(done.is_ok());
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(model.uav_count() > 1 && new.linked(0, 1), "a link");
    kani::cover!(
        !old.informed(0) && new.informed(0),
        "a hotspot becomes informed"
    );
    kani::cover!(new.grounded(0), "a grounded UAV");
    nothing_is_forgotten(&model, &old, &new);
    assert!(new.mean_throughput() >= 0.0 && new.mean_throughput() <= 1e9);
    assert!(new.fleet_is_valid(&model, Phase::Communicated));
}

/// Energy, charge, carbon, reward, termination: ledgers grow, and the episode ends at the horizon.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(13))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::stub(crate::rng::block, any_block))]
#[cfg_attr(kani, kani::stub(crate::potential::update, any_potentials))]
#[cfg_attr(kani, kani::stub(crate::reward::RewardPlan::components, any_rewards))]
#[cfg_attr(kani, kani::stub_verified(crate::energy::settle))]
pub fn ending_a_step_keeps_the_state_valid() {
    let mut tables = [0; TABLE_WORDS];
    let model = any_model(&mut tables);
    let before = any_state(&model, Phase::Communicated);
    let mut after = before;
    let mut scratch: [u64; SCRATCH_WORDS] = kani::any();
    let mut scratch = Scratch::new(&model, &mut scratch).unwrap();
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

/// Whatever the phase and whatever the actions: a refused part leaves every word as it was.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(5))]
pub fn a_refused_step_changes_nothing() {
    let mut tables = [0; TABLE_WORDS];
    let model = any_model(&mut tables);
    let phase = match between(0, 3) {
        0 => Phase::Terminated,
        1 => Phase::Truncated,
        2 => Phase::Moved,
        _ => Phase::Ready,
    };
    let before = any_fleet(&model, phase);
    let mut after = before;
    let mut actions = any_actions();
    if phase == Phase::Ready {
        actions[between(0, model.action_len() as u64 - 1) as usize] = f32::NAN;
    }
    let len = model.action_len();
    let refusal = model.step_begin(&mut open(&model, &mut after), &actions[..len]);
    kani::cover!(
        matches!(refusal, Err(Error::ActionNan { .. })),
        "not a number"
    );
    kani::cover!(
        matches!(refusal, Err(Error::OutOfOrder { .. })),
        "out of order"
    );
    kani::cover!(matches!(refusal, Err(Error::EpisodeOver)), "after the end");
    assert!(refusal.is_err());
    assert!(!phase.is_over() || refusal == Err(Error::EpisodeOver));
    assert!(!differ(&before, &after));
}

/// Equal inputs give equal outputs: what working memory held before does not matter.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn working_memory_does_not_matter() {
    let mut tables = [0; TABLE_WORDS];
    let model = any_model(&mut tables);
    let mut one = any_fleet(&model, Phase::Sensed);
    let mut other = one;
    let mut scratch: [u64; SCRATCH_WORDS] = kani::any();
    let mut zeros = [0; SCRATCH_WORDS];
    let mut scratch = Scratch::new(&model, &mut scratch).unwrap();
    let mut zeros = Scratch::new(&model, &mut zeros).unwrap();
    let first = model.step_communicate(&mut open(&model, &mut one), &mut scratch);
    let second = model.step_communicate(&mut open(&model, &mut other), &mut zeros);
    kani::cover!(view(&model, &one).informed(0), "an informed hotspot");
    assert!(first == second);
    assert!(!differ(&one, &other));
}

#[cfg(not(kani))]
super::standin::twins! {
    reset_makes_a_valid_state: 1000 cases, 2 covers;
    beginning_a_step_keeps_the_state_valid: 2000 cases, 3 covers;
    sensing_keeps_the_state_valid: 2000 cases, 3 covers;
    communicating_keeps_the_state_valid: 2000 cases, 3 covers;
    ending_a_step_keeps_the_state_valid: 2000 cases, 3 covers;
    a_refused_step_changes_nothing: 2000 cases, 3 covers;
    working_memory_does_not_matter: 500 cases, 1 covers;
}

#[cfg(test)]
mod sizes {
    use crate::layout::Layout;
    use crate::model::Model;
    use crate::model::any_model::{SMALLEST_TABLE_WORDS, smallest};

    /// Catches a change of the layout that Kani's fixed sizes do not follow.
    #[test]
    fn the_smallest_model_has_the_sizes_that_kani_is_given() {
        assert_eq!(Layout::of(&smallest()).end, super::SMALLEST_STATE_WORDS);
        assert_eq!(Model::table_words(&smallest()), Ok(SMALLEST_TABLE_WORDS));
    }
}
