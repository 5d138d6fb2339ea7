//! P6: a refused call changes no word. Refused here are calls out of order, calls with data of
//! another length, and a step with a NaN action. `host` has the other refusals of a host's calls.
//!
//! Phases and lengths are constants. A call that the first check refuses costs the solver only that
//! check, so that the state may hold any words.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use super::state::{ACTIONS, STATE_WORDS, any_actions, any_fleet, any_phase, differ, open, view};
use crate::config::Cell;
use crate::error::Error;
use crate::model::Model;
use crate::state::header::{self, Phase};

/// Room for a cell or a charge more than the smallest model, or any that the stand-in makes, has
/// UAVs.
const MORE: usize = ACTIONS / 2 + 1;
/// Room for a byte more than such a model has pairs of UAVs, or of a UAV and a hotspot.
const PAIRS: usize = (ACTIONS / 2) * (ACTIONS / 2) + 1;

/// Any words of the phase, valid or not.
fn any_words(phase: Phase) -> [u64; STATE_WORDS] {
    let mut words: [u64; STATE_WORDS] = kani::any();
    words[header::PHASE] = phase as u64;
    words
}

/// Out of its order, or after the end.
fn out_of_order(phase: Phase, refusal: Result<(), Error>) {
    if phase.is_over() {
        assert!(matches!(refusal, Err(Error::EpisodeOver)));
    } else {
        assert!(matches!(refusal, Err(Error::OutOfOrder { .. })));
    }
}

/// The parts of a step that do not belong to the phase.
fn parts_are_refused(model: &Model<'_>, phase: Phase) {
    let before = any_words(phase);
    let mut after = before;
    given!(scratch for model);
    let (actions, mut state) = (any_actions(), open(model, &mut after));
    let actions = &actions[..model.action_len()];
    if phase != Phase::Ready {
        out_of_order(phase, model.step_begin(&mut state, actions));
        let whole = model.step(&mut state, &mut scratch, actions);
        out_of_order(phase, whole.map(|_| ()));
    }
    if phase != Phase::Moved {
        out_of_order(phase, model.step_sense(&mut state, &mut scratch));
    }
    if phase != Phase::Sensed {
        out_of_order(phase, model.step_communicate(&mut state, &mut scratch));
    }
    if phase != Phase::Communicated {
        let end = model.step_end(&mut state, &mut scratch);
        out_of_order(phase, end.map(|_| ()));
    }
    assert!(!differ(&before, &after));
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(5))]
pub fn parts_out_of_their_order_change_nothing() {
    given!(model);
    parts_are_refused(&model, Phase::Ready);
    parts_are_refused(&model, Phase::Moved);
    parts_are_refused(&model, Phase::Sensed);
    parts_are_refused(&model, Phase::Communicated);
    parts_are_refused(&model, Phase::Terminated);
    parts_are_refused(&model, Phase::Truncated);
    kani::cover!(true, "every phase");
}

/// A host's calls that do not belong to the phase.
fn host_calls_are_refused(model: &Model<'_>, phase: Phase) {
    let before = any_words(phase);
    let mut after = before;
    given!(scratch for model);
    let mut state = open(model, &mut after);
    let (cells, charges, bytes) = ([Cell { x: 0, y: 0 }; MORE], [0; MORE], [0; PAIRS]);
    let (uavs, hotspots) = (model.uav_count(), model.hotspot_count());
    if phase != Phase::Moved {
        let pairs = &bytes[..uavs * hotspots];
        out_of_order(phase, model.set_positions(&mut state, &cells[..uavs]));
        out_of_order(phase, model.ground(&mut state, 0));
        out_of_order(phase, model.confirm_hotspot(&mut state, 0));
        out_of_order(
            phase,
            model.step_sense_with(&mut state, &mut scratch, pairs),
        );
    }
    if phase != Phase::Sensed {
        let pairs = &bytes[..uavs * uavs];
        let done = model.step_communicate_with(&mut state, &mut scratch, pairs, None);
        out_of_order(phase, done);
    }
    if phase != Phase::Ready {
        let (state, scratch) = (&mut state, &mut scratch);
        out_of_order(phase, model.set_starts(state, scratch, &cells[..uavs]));
        out_of_order(
            phase,
            model.set_hotspots(state, scratch, &cells[..hotspots]),
        );
        out_of_order(phase, model.move_hotspot(state, scratch, 0, cells[0]));
        out_of_order(phase, model.set_batteries(state, scratch, &charges[..uavs]));
        out_of_order(phase, model.set_battery(state, scratch, 0, 0));
    }
    assert!(!differ(&before, &after));
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(5))]
pub fn host_calls_out_of_their_order_change_nothing() {
    given!(model);
    host_calls_are_refused(&model, Phase::Ready);
    host_calls_are_refused(&model, Phase::Moved);
    host_calls_are_refused(&model, Phase::Sensed);
    host_calls_are_refused(&model, Phase::Communicated);
    host_calls_are_refused(&model, Phase::Terminated);
    host_calls_are_refused(&model, Phase::Truncated);
    kani::cover!(true, "every phase");
}

/// Data one element too short or too long, and none at all.
fn other_lengths(right: usize) -> [usize; 3] {
    [0, right - 1, right + 1]
}

/// The call is refused for its data's length.
fn of_another_length(refusal: Result<(), Error>) {
    assert!(matches!(refusal, Err(Error::Length { .. })));
}

/// Before the first step.
fn lengths_are_refused_at_the_start(model: &Model<'_>) {
    let mut before = any_words(Phase::Ready);
    before[header::T] = 0;
    let mut after = before;
    given!(scratch for model);
    let (actions, cells, charges) = ([0.0; ACTIONS + 1], [Cell { x: 0, y: 0 }; MORE], [0; MORE]);
    let (state, scratch) = (&mut open(model, &mut after), &mut scratch);
    for which in 0..3 {
        let len = other_lengths(model.action_len())[which];
        of_another_length(model.step_begin(state, &actions[..len]));
        let len = other_lengths(model.uav_count())[which];
        of_another_length(model.set_starts(state, scratch, &cells[..len]));
        of_another_length(model.set_batteries(state, scratch, &charges[..len]));
        let len = other_lengths(model.hotspot_count())[which];
        of_another_length(model.set_hotspots(state, scratch, &cells[..len]));
    }
    assert!(!differ(&before, &after));
}

/// Within a step.
fn lengths_are_refused_within_a_step(model: &Model<'_>) {
    let (moved, sensed) = (any_words(Phase::Moved), any_words(Phase::Sensed));
    let (mut after_moved, mut after_sensed) = (moved, sensed);
    given!(scratch for model);
    let (uavs, hotspots) = (model.uav_count(), model.hotspot_count());
    let (cells, bytes, reals) = ([Cell { x: 0, y: 0 }; MORE], [0; PAIRS], [0.0; MORE]);
    for which in 0..3 {
        let state = &mut open(model, &mut after_moved);
        let len = other_lengths(uavs)[which];
        of_another_length(model.set_positions(state, &cells[..len]));
        let len = other_lengths(uavs * hotspots)[which];
        of_another_length(model.step_sense_with(state, &mut scratch, &bytes[..len]));
        let state = &mut open(model, &mut after_sensed);
        let len = other_lengths(uavs * uavs)[which];
        of_another_length(model.step_communicate_with(state, &mut scratch, &bytes[..len], None));
        let (links, len) = (&bytes[..uavs * uavs], other_lengths(uavs)[which]);
        let measured = Some(&reals[..len]);
        of_another_length(model.step_communicate_with(state, &mut scratch, links, measured));
    }
    assert!(!differ(&moved, &after_moved));
    assert!(!differ(&sensed, &after_sensed));
}

/// Memory too short for a state, to begin in or to load into.
fn short_memory_is_refused(model: &Model<'_>) {
    let before: [u64; STATE_WORDS] = kani::any();
    let (mut after, mut spare) = (before, [0; STATE_WORDS]);
    given!(scratch for model);
    let words = model.state_words();
    for which in 0..2 {
        let len = other_lengths(words)[which];
        of_another_length(model.reset(&mut after[..len], &mut scratch, 0));
        of_another_length(model.load(&[], &mut after[..len], &mut spare[..words]));
        of_another_length(model.load(&[], &mut after[..words], &mut spare[..len]));
    }
    assert!(!differ(&before, &after));
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(5))]
pub fn data_of_another_length_changes_nothing() {
    given!(model);
    short_memory_is_refused(&model);
    lengths_are_refused_at_the_start(&model);
    lengths_are_refused_within_a_step(&model);
    kani::cover!(true, "every call");
}

/// One action that is not a number refuses the step.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(5))]
pub fn a_step_with_a_nan_changes_nothing() {
    given!(model);
    let before = any_fleet(&model, Phase::Ready);
    let mut after = before;
    let mut actions = any_actions();
    let len = model.action_len();
    let place = between(0, len as u64 - 1) as usize;
    actions[place] = f32::NAN;
    let refusal = model.step_begin(&mut open(&model, &mut after), &actions[..len]);
    kani::cover!(place == 0, "the first");
    kani::cover!(place + 1 == len, "the last");
    kani::cover!(view(&model, &before).t() > 0, "after the reset");
    assert!(matches!(
        refusal,
        Err(Error::ActionNan { uav, component }) if 2 * uav + component == place
    ));
    assert!(!differ(&before, &after));
}

/// Environments of the batch.
const BATCH: usize = 2;

/// A batch is checked whole before its first environment steps: what is accepted has no step
/// refused.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(9))]
pub fn a_batch_that_is_accepted_has_no_step_refused() {
    given!(model);
    let (len, actions_len) = (model.state_words(), model.action_len());
    let mut words = [0; BATCH * STATE_WORDS];
    for m in 0..BATCH {
        let one = any_words(any_phase());
        words[m * len..(m + 1) * len].copy_from_slice(&one[..len]);
        words[m * len + header::CONFIG_HASH] = model.config_hash() ^ between(0, 1);
    }
    let actions: [f32; BATCH * ACTIONS] = kani::any();
    let (states, actions) = (&words[..BATCH * len], &actions[..BATCH * actions_len]);
    let checked = model.check_batch(states, actions, BATCH);
    kani::cover!(checked.is_ok(), "a batch that steps");
    kani::cover!(checked == Err(Error::EpisodeOver), "one that has ended");
    kani::cover!(checked == Err(Error::ModelMismatch), "one of another model");
    let m = between(0, BATCH as u64 - 1) as usize;
    let state = model.state(&states[m * len..(m + 1) * len]);
    let ready = state.is_ok_and(|state| state.header.phase() == Some(Phase::Ready));
    let index = between(0, (BATCH * actions_len) as u64 - 1) as usize;
    assert!(checked.is_err() || ready && !actions[index].is_nan());
}

#[cfg(not(kani))]
super::standin::twins! {
    a_batch_that_is_accepted_has_no_step_refused: 4000 cases, 3 covers;
    parts_out_of_their_order_change_nothing: 1000 cases, 1 covers;
    host_calls_out_of_their_order_change_nothing: 1000 cases, 1 covers;
    data_of_another_length_changes_nothing: 1000 cases, 1 covers;
    a_step_with_a_nan_changes_nothing: 2000 cases, 3 covers;
}
