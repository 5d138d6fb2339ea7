//! Helpers of the proofs of whole calls: any valid state of a phase, and relations between two
//! states.
//!
//! A state is valid (`StateRef::is_valid`) if it belongs to the model, its fleet is valid
//! (`fleet_is_valid`) and its scalars are (`scalars_are_valid`). The parts of a step before its end
//! change neither the scalars nor the rewards and potentials of UAVs that are checked with them.
//! Their proofs show [`carries_scalars`], and `step::carried_scalars_stay_valid` shows what
//! follows.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::config::QuorumWindow;
use crate::constants::reward::OWN_KEPT;
use crate::model::Model;
#[cfg(not(kani))]
use crate::model::any_model::UAVS_MAX;
use crate::state::header::{self, Phase};
#[cfg(not(kani))]
use crate::state::scratch::Scratch;
use crate::state::validity::THROUGHPUT_MAX;
use crate::state::{StateMut, StateRef};
use crate::words::bits;

/// Words of a state of the smallest model as Kani sees it, with one component of each reward.
#[cfg(any(kani, test))]
pub(super) const SMALLEST_STATE_WORDS: usize = 57;
/// The same with two hotspots: for the second a cell, a time of confirmation and one at which all
/// know it.
#[cfg(any(kani, test))]
pub(super) const SMALLEST_SPREAD_WORDS: usize = SMALLEST_STATE_WORDS + 3;
/// The same where the quorum counts the episode: what each UAV remembers.
#[cfg(any(kani, test))]
pub(super) const SMALLEST_REMEMBERING_WORDS: usize = SMALLEST_STATE_WORDS + 2;
/// Words of a state of any model whose quorum counts the episode.
#[cfg(kani)]
pub(super) const REMEMBERING_WORDS: usize = SMALLEST_REMEMBERING_WORDS;
/// Words of a state of any model whose quorum counts the episode.
#[cfg(not(kani))]
pub(super) const REMEMBERING_WORDS: usize = STATE_WORDS;
/// Words of a state of any model that Kani sees.
#[cfg(kani)]
pub(super) const STATE_WORDS: usize = SMALLEST_STATE_WORDS;
/// Words of a state of any model that the stand-in makes.
#[cfg(not(kani))]
pub(super) const STATE_WORDS: usize = 4096;
/// Words of working memory of the smallest model.
#[cfg(any(kani, test))]
pub(super) const SMALLEST_SCRATCH_WORDS: usize = 15;
/// The same with two hotspots.
#[cfg(any(kani, test))]
pub(super) const SMALLEST_SPREAD_SCRATCH_WORDS: usize = SMALLEST_SCRATCH_WORDS + 1;
/// Words of working memory of any model that Kani sees.
#[cfg(kani)]
pub(super) const SCRATCH_WORDS: usize = SMALLEST_SCRATCH_WORDS;
/// Words of working memory of any model that the stand-in makes.
#[cfg(not(kani))]
pub(super) const SCRATCH_WORDS: usize = 512;
/// Two components for each UAV of the smallest model, and for each of as many as the stand-in has.
#[cfg(kani)]
pub(super) const ACTIONS: usize = 4;
/// Two components for each UAV of the smallest model, and for each of as many as the stand-in has.
#[cfg(not(kani))]
pub(super) const ACTIONS: usize = 2 * UAVS_MAX;

pub(super) fn view<'a>(model: &Model<'_>, words: &'a [u64]) -> StateRef<'a> {
    StateRef::split(*model.layout(), &words[..model.state_words()])
}

pub(super) fn open<'a>(model: &Model<'_>, words: &'a mut [u64]) -> StateMut<'a> {
    StateMut::split(*model.layout(), &mut words[..model.state_words()])
}

/// Any state of the phase that is valid but perhaps for its scalars.
pub(super) fn any_fleet(model: &Model<'_>, phase: Phase) -> [u64; STATE_WORDS] {
    any_fleet_in(model, phase)
}

/// The same in as many words as the model's states need.
#[cfg(kani)]
pub(super) fn any_fleet_in<const W: usize>(model: &Model<'_>, phase: Phase) -> [u64; W] {
    let words: [u64; W] = kani::any();
    let state = view(model, &words);
    kani::assume(state.header.phase() == Some(phase));
    kani::assume(state.header.config_hash() == model.config_hash());
    kani::assume(state.fleet_is_valid(model, phase));
    words
}

/// A state of the phase on a random flight.
#[cfg(not(kani))]
pub(super) fn any_fleet_in<const W: usize>(model: &Model<'_>, phase: Phase) -> [u64; W] {
    let mut words = [0; W];
    let mut scratch = [0; SCRATCH_WORDS];
    let mut scratch = Scratch::new(model, &mut scratch).ok().unwrap();
    let steps = between(0, u64::from(model.config().horizon_steps));
    model
        .reset(&mut words[..model.state_words()], &mut scratch, kani::any())
        .unwrap();
    let mut state = open(model, &mut words);
    for _ in 0..steps {
        if state.header.phase() != Some(Phase::Ready) {
            break;
        }
        if between(0, 7) == 0 {
            let charge_uj = between(0, model.energy().capacity_uj);
            model
                .set_battery(&mut state, &mut scratch, 0, charge_uj)
                .unwrap();
        }
        if phase == Phase::Ready && kani::any() {
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
    kani::assume(view(model, &words).scalars_are_valid(model));
    words
}

/// Any of the six phases.
pub(super) fn any_phase() -> Phase {
    match between(1, 6) {
        1 => Phase::Ready,
        2 => Phase::Moved,
        3 => Phase::Sensed,
        4 => Phase::Communicated,
        5 => Phase::Terminated,
        _ => Phase::Truncated,
    }
}

/// Any actions that are numbers.
pub(super) fn any_actions() -> [f32; ACTIONS] {
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

/// The scalars that a part of a step may change before its end: time, phase, mean throughput.
pub(super) fn changes_before_the_end(index: usize) -> bool {
    index == header::T || index == header::PHASE || index == header::MEAN_THROUGHPUT
}

/// Checks the scalars after a part before the end of a step. The number of settled steps is the
/// same, the mean throughput is the same or in its range, and no other scalar changes. Kani checks
/// any one scalar, and the stand-in checks all.
pub(super) fn carries_scalars(before: &StateRef<'_>, after: &StateRef<'_>) {
    assert!(before.settled_steps() == after.settled_steps());
    assert!(carries_mean_throughput(before, after));
    carries_uav_rewards(before, after);
    if cfg!(kani) {
        carries_scalar(before, after, between(0, header::WORDS as u64 - 1) as usize);
    } else {
        for index in 0..header::WORDS {
            carries_scalar(before, after, index);
        }
    }
}

/// What a part before the end of a step does to rewards and potentials of UAVs: nothing. Kani looks
/// at any one UAV and the reward's one component, the stand-in at all.
fn carries_uav_rewards(before: &StateRef<'_>, after: &StateRef<'_>) {
    if cfg!(kani) {
        let i = between(0, before.uav_count() as u64 - 1) as usize;
        assert!(before.goal_potential[i] == after.goal_potential[i]);
        assert!(before.charge_potential[i] == after.charge_potential[i]);
        assert!(before.own_rewards[i * OWN_KEPT] == after.own_rewards[i * OWN_KEPT]);
    } else {
        assert!(before.goal_potential == after.goal_potential);
        assert!(before.charge_potential == after.charge_potential);
        assert!(before.own_rewards == after.own_rewards);
    }
}

fn carries_scalar(before: &StateRef<'_>, after: &StateRef<'_>, index: usize) {
    assert!(changes_before_the_end(index) || before.header.0[index] == after.header.0[index]);
}

/// A mean throughput that is the one before, or in its range.
pub(super) fn carries_mean_throughput(before: &StateRef<'_>, after: &StateRef<'_>) -> bool {
    let word = after.header.0[header::MEAN_THROUGHPUT];
    let throughput = after.mean_throughput();
    word == before.header.0[header::MEAN_THROUGHPUT]
        || throughput >= 0.0 && throughput <= THROUGHPUT_MAX && word != (-0.0f64).to_bits()
}

/// Nothing known, confirmed or informed before is so no longer.
pub(super) fn nothing_is_forgotten(model: &Model<'_>, before: &StateRef<'_>, after: &StateRef<'_>) {
    for j in 0..model.hotspot_count() {
        assert!(!before.confirmed(j) || after.confirmed(j));
        assert!(!before.informed(j) || after.informed(j));
        for i in 0..model.uav_count() {
            assert!(!before.knows(i, j) || after.knows(i, j));
        }
    }
    assert!(bits::is_subset(
        before.falsely_confirmed,
        after.falsely_confirmed
    ));
    assert!(bits::is_subset(before.remembered, after.remembered));
    assert!(bits::is_subset(
        before.remembered_false,
        after.remembered_false
    ));
    assert!(bits::is_subset(before.sightings, after.sightings));
    assert!(bits::is_subset(before.reports, after.reports));
}

/// A hotspot becomes confirmed exactly if the UAVs whose detection of it is on record reach the
/// quorum.
pub(super) fn confirms_by_quorum(model: &Model<'_>, old: &StateRef<'_>, new: &StateRef<'_>) {
    for j in 0..model.hotspot_count() {
        let mut count = 0;
        for i in 0..model.uav_count() {
            count += u32::from(counts_toward_quorum(model, new, i, j));
        }
        let reached = count >= model.config().quorum;
        assert!(new.confirmed(j) == (old.confirmed(j) || reached));
    }
}

/// Whether a detection of UAV `i` counts for hotspot `j`: of this step or of the episode.
pub(super) fn counts_toward_quorum(
    model: &Model<'_>,
    state: &StateRef<'_>,
    i: usize,
    j: usize,
) -> bool {
    match model.config().quorum_window {
        QuorumWindow::Step => state.detected(i, j),
        QuorumWindow::Episode => state.remembered(i, j),
    }
}

/// What building a graph needs of a state: cells on the grid, pilot densities in their range.
pub(super) fn radios_are_valid(model: &Model<'_>, state: &StateRef<'_>) -> bool {
    let config = model.config();
    for i in 0..model.uav_count() {
        let density = state.pilot_density(i);
        let in_range = density >= config.pilot_density_min && density <= config.pilot_density_max;
        if !in_range || !model.contains(state.cell(i)) {
            return false;
        }
    }
    bits::fits(state.grounded, model.uav_count())
}

/// Links are of the fleet, and nobody's to itself.
pub(super) fn links_join_two(model: &Model<'_>, state: &StateRef<'_>) -> bool {
    for i in 0..model.uav_count() {
        if !bits::fits(state.links_of(i), model.uav_count()) || state.linked(i, i) {
            return false;
        }
    }
    true
}
