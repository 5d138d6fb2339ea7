//! One step of the simulation, as a whole or in four parts.
//!
//! [`Model::step`] runs the whole step. A host simulator calls the four parts instead and replaces
//! parts of the model between them, for example positions before sensing.

use crate::error::Error;
use crate::model::Model;
use crate::rules::reward::{self, Billed, StepTotals};
use crate::rules::{
    action, alarms, carbon, coverage, energy, graph, knowledge, metrics, potential, reports,
    sensing,
};
use crate::state::StateMut;
use crate::state::header::Phase;
use crate::state::scratch::Scratch;

/// The result of a step: the team's reward, and whether the episode has ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepOutcome {
    /// The team's reward R_t; the mean of the UAVs' own rewards.
    pub reward: f64,
    /// Number of cells without a hotspot that a quorum confirmed in this step.
    pub false_confirmations: u32,
    /// True if all UAVs know all hotspots and all are confirmed, which ends the episode.
    pub terminated: bool,
    /// True if the episode ended at the horizon without termination.
    pub truncated: bool,
}

impl Model<'_> {
    /// Runs one whole step.
    ///
    /// `actions` is an N × 2 matrix, row by row: `actions[2 * i]` is the direction of UAV `i` and
    /// `actions[2 * i + 1]` its pilot density. Both are reals that are clipped to [−1, 1].
    ///
    /// The direction selects one of five equal bins of [−1, 1], by default +y, −y, −x, +x, stay.
    /// The pilot density maps −1 to `pilot_density_min` and 1 to `pilot_density_max`, linearly.
    ///
    /// ```
    /// # #[cfg(feature = "alloc")] {
    /// use jcas_core::{Config, Model, Motion, MotionMap, Scratch};
    ///
    /// let model = Model::new(Config::default())?;
    /// let mut words = vec![0; model.state_words()];
    /// let mut memory = vec![0; Scratch::words_for(&model)];
    /// let mut scratch = Scratch::new(&model, &mut memory)?;
    /// model.reset(&mut words, &mut scratch, 42)?;
    ///
    /// let mut state = model.state_mut(&mut words)?;
    /// let actions = [Motion::Up.to_action(MotionMap::Udlrs), -1.0].repeat(model.uav_count());
    /// let outcome = model.step(&mut state, &mut scratch, &actions)?;
    /// assert!(outcome.reward.is_finite());
    /// assert_eq!(state.as_ref().t(), 1);
    /// # }
    /// # Ok::<(), jcas_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::EpisodeOver`], [`Error::OutOfOrder`], [`Error::Length`] or [`Error::ActionNan`].
    /// The state does not change then.
    pub fn step(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
        actions: &[f32],
    ) -> Result<StepOutcome, Error> {
        step_inline(self, state, scratch, actions)
    }

    /// Part 1 of a step: applies the actions, returns UAVs with a low battery to base, and moves.
    ///
    /// `actions` has the shape and range that [`Model::step`] describes.
    ///
    /// # Errors
    /// The errors of [`Model::step`].
    pub fn step_begin(&self, state: &mut StateMut<'_>, actions: &[f32]) -> Result<(), Error> {
        begin(self, state, actions)
    }

    /// Part 2 of a step: updates the search maps, senses hotspots and learns those detected.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`] unless part 1 came last.
    pub fn step_sense(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
    ) -> Result<(), Error> {
        sense(self, state, scratch)
    }

    /// Part 3 of a step: builds the radio graph from the link budget and communicates over it.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`] unless part 2 came last.
    pub fn step_communicate(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
    ) -> Result<(), Error> {
        communicate(self, state, scratch)
    }

    /// Part 4 of a step: settles energy, charging, carbon and reward, and decides whether the
    /// episode ends.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`] unless part 3 came last.
    pub fn step_end(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
    ) -> Result<StepOutcome, Error> {
        end(self, state, scratch)
    }
}

// The parts are compiled into their callers, for the instruction set of the caller.

/// Does the same as [`Model::step`], compiled into its caller.
#[inline(always)]
pub(crate) fn step_inline(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
    actions: &[f32],
) -> Result<StepOutcome, Error> {
    begin(model, state, actions)?;
    sense(model, state, scratch)?;
    communicate(model, state, scratch)?;
    end(model, state, scratch)
}

#[inline(always)]
fn begin(model: &Model<'_>, state: &mut StateMut<'_>, actions: &[f32]) -> Result<(), Error> {
    require_phase(state, Phase::Ready, "step_begin", "reset or step_end")?;
    check_actions(model, actions)?;
    let t = state.header.t() + 1;
    state.header.set_t(t);
    action::act(model, state, actions);
    state.header.set_phase(Phase::Moved);
    Ok(())
}

#[inline(always)]
fn sense(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
) -> Result<(), Error> {
    require_phase(state, Phase::Moved, "step_sense", "step_begin")?;
    sensing::look_around(model, state);
    sensing::sense_and_learn(model, state, scratch);
    if model.layout().alarms > 0 {
        alarms::raise(model, state, scratch);
        reports::sight(model, state);
    }
    state.header.set_phase(Phase::Sensed);
    Ok(())
}

#[inline(always)]
fn communicate(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
) -> Result<(), Error> {
    require_phase(state, Phase::Sensed, "step_communicate", "step_sense")?;
    graph::build_graph(model, state, scratch);
    knowledge::communicate(model, state, scratch);
    state.header.set_phase(Phase::Communicated);
    Ok(())
}

#[inline(always)]
fn end(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
) -> Result<StepOutcome, Error> {
    require_phase(state, Phase::Communicated, "step_end", "step_communicate")?;
    let mut totals = StepTotals {
        goal_potential_before: state.header.goal_potential(),
        charge_potential_before: state.header.charge_potential(),
        mean_throughput: state.header.mean_throughput(),
        newly_false: alarms::newly_false(state),
        ..StepTotals::default()
    };
    let (mut per_uav, mut rest) = scratch.per_uav(model.uav_count());
    let settled = energy::settle_fleet(model, state, &mut per_uav, &mut totals);
    let billed_uj = settled.billed_uj;
    let co2_ng = carbon::emit(model, state, billed_uj, &mut totals);
    metrics::add_step(state, &settled);
    coverage::update(model, state, &mut per_uav, &mut totals);
    knowledge::count(model, state, &mut totals);
    potential::save(model, state, &mut per_uav);
    decide_end(model, state, &mut rest, &mut totals);

    let rewards = model.reward().components(&totals);
    let reward = reward::total(&rewards);
    state.header.set_rewards(&rewards);
    reward::credit(model, state, &per_uav, Billed { co2_ng, billed_uj });
    let return_sum = state.header.return_sum() + reward;
    state.header.set_return_sum(return_sum);
    let phase = state.header.phase();
    Ok(StepOutcome {
        reward,
        false_confirmations: totals.newly_false as u32,
        terminated: phase == Some(Phase::Terminated),
        truncated: phase == Some(Phase::Truncated),
    })
}

/// Refuses a call that comes out of order.
#[inline(always)]
pub(crate) fn require_phase(
    state: &StateMut<'_>,
    phase: Phase,
    called: &'static str,
    after: &'static str,
) -> Result<(), Error> {
    match state.header.phase() {
        Some(now) if now == phase => Ok(()),
        Some(now) if now.is_over() => Err(Error::EpisodeOver),
        Some(_) => Err(Error::OutOfOrder { called, after }),
        None => Err(Error::ModelMismatch),
    }
}

#[inline(always)]
fn check_actions(model: &Model<'_>, actions: &[f32]) -> Result<(), Error> {
    if actions.len() != model.action_len() {
        return Err(Error::Length {
            what: "actions",
            expected: model.action_len(),
            got: actions.len(),
        });
    }
    action::refuse_nan(actions)
}

/// Decides whether the episode ends, and computes the potentials of the new state.
#[inline(always)]
fn decide_end(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
    totals: &mut StepTotals,
) {
    let hotspots = model.hotspot_count() as u64;
    totals.complete = totals.informed == hotspots && totals.confirmed == hotspots;
    totals.at_horizon = state.header.t() >= model.config().horizon_steps;
    potential::update(model, state, scratch, totals.complete);
    totals.goal_potential_after = state.header.goal_potential();
    totals.charge_potential_after = state.header.charge_potential();
    state.header.set_phase(if totals.complete {
        Phase::Terminated
    } else if totals.at_horizon {
        Phase::Truncated
    } else {
        Phase::Ready
    });
}
