//! A policy that plans anew during an episode, after each confirmation and each meeting.

use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::ControlFlow;

use jcas_core::{Cell, Model, StateRef, TargetVisibility};

use crate::anneal::Settings;
use crate::error::PlanError;
use crate::follow::write;
use crate::memory;
use crate::objective::missed_after;
use crate::plan::{Plan, improve, starts};
use crate::problem::{Problem, Situation};
use crate::rounds::{self, Rounds};
use crate::targets::{Targets, index_of};

/// A planner that plans before the first step, and anew in each radio component whose knowledge has
/// changed.
///
/// A component plans for its members by what they know. That is their own cells and charges, the
/// hotspots that they know, and the plan that they share with the others. It assumes that the
/// others follow that plan. All members of a component compute the same plan, bit by bit.
#[derive(Clone, Debug)]
pub struct Replanner {
    settings: Settings,
    first_iterations: u64,
    /// The view of all UAVs before the first step.
    first: Option<Arc<View>>,
    /// The view of each UAV.
    views: Vec<Arc<View>>,
    /// The members of each radio component.
    components: Vec<Vec<usize>>,
}

/// A plan as the members of a component share it.
#[derive(Clone, Debug)]
struct View {
    first_step: u32,
    plan: Plan,
    /// The hotspots that the members knew when they planned.
    known: Vec<bool>,
    /// The prior of the hidden hotspots, for each cell; empty if positions are known.
    weights: Vec<f64>,
    /// The rounds that the plan begins, where they are faster than fixed trajectories.
    rounds: Option<Rounds>,
}

impl View {
    fn flown(&self, state: &StateRef<'_>) -> usize {
        state.t().saturating_sub(self.first_step) as usize
    }

    /// Returns the cell of a UAV in the plan now.
    fn cell(&self, state: &StateRef<'_>, uav: usize) -> Cell {
        self.plan.cell(uav, self.flown(state))
    }
}

impl Replanner {
    /// Makes a planner with `first_iterations` before the first step, and with those of the
    /// settings later.
    #[must_use]
    pub fn new(first_iterations: u64, settings: Settings) -> Self {
        Self {
            settings,
            first_iterations,
            first: None,
            views: Vec::new(),
            components: Vec::new(),
        }
    }

    /// Called before the first step of an episode.
    pub fn reset(&mut self) {
        // With hidden hotspots, the first plan is the same in every episode.
        self.first = self.first.take().filter(|view| !view.weights.is_empty());
        self.views.clear();
    }

    /// Returns the plan that a UAV follows at present. There is none before the first step.
    #[must_use]
    pub fn plan_of(&self, uav: usize) -> Option<&Plan> {
        self.views.get(uav).map(|view| &view.plan)
    }

    /// Makes the plans that are due in this state.
    ///
    /// # Errors
    /// [`PlanError`], where the fleet or the grid is too large, or where there is no memory for a
    /// plan.
    pub fn try_plan(&mut self, model: &Model<'_>, state: &StateRef<'_>) -> Result<(), PlanError> {
        let hidden = model.config().target_visibility == TargetVisibility::Hidden;
        memory::check(
            model,
            (!hidden).then(|| state.hotspot_count()),
            state.uav_count(),
        )?;
        if self.views.is_empty() {
            let first = match self.first.take() {
                Some(first) => first,
                None if hidden => self.search(model)?,
                None => self.tour(model, state)?,
            };
            self.views = vec![Arc::clone(&first); state.uav_count()];
            self.first = Some(first);
        }
        let mut open: Vec<usize> = (0..state.uav_count()).collect();
        self.components.clear();
        while let Some(&first) = open.first() {
            let members = component(state, first);
            open.retain(|uav| !members.contains(uav));
            self.share(model, state, &members)?;
            self.components.push(members);
        }
        Ok(())
    }

    /// Writes (u_dir, u_pilot) of each UAV, each in [-1, 1], for the state of the last
    /// [`Replanner::try_plan`].
    pub fn write(&self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        for members in &self.components {
            self.write_members(model, state, members, actions);
        }
    }

    /// Makes the first plan, which is the same in every episode if hotspots are hidden.
    ///
    /// # Errors
    /// [`PlanError`], where the fleet or the grid is too large, or where there is no memory for a
    /// plan.
    pub fn prepare(&mut self, model: &Model<'_>) -> Result<(), PlanError> {
        memory::check(model, None, 1)?;
        self.first = Some(self.search(model)?);
        self.views.clear();
        Ok(())
    }

    fn search(&self, model: &Model<'_>) -> Result<Arc<View>, PlanError> {
        let targets = Targets::hidden(model);
        // The plan holds for the least charges.
        self.begun(model, &targets, &[], Situation::at_reset(model))
    }

    fn tour(&self, model: &Model<'_>, state: &StateRef<'_>) -> Result<Arc<View>, PlanError> {
        let hotspots = hotspot_cells(state);
        let targets = Targets::known(model, &hotspots)?;
        self.begun(model, &targets, &hotspots, Situation::of(state))
    }

    fn begun(
        &self,
        model: &Model<'_>,
        targets: &Targets,
        hotspots: &[Cell],
        situation: Situation,
    ) -> Result<Arc<View>, PlanError> {
        let problem = Problem::new(model, targets, situation)?;
        let settings = Settings {
            iterations: self.first_iterations,
            ..self.settings
        };
        let mut plan = improve(&problem, starts(&problem), &settings, &mut go_on);
        let known = vec![false; model.hotspot_count()];
        let rounds = faster_rounds(&problem, hotspots, &known, None, &settings, &mut plan);
        let weights = match targets.groups().first() {
            Some(group) if model.config().target_visibility == TargetVisibility::Hidden => {
                group.weights.clone()
            }
            _ => Vec::new(),
        };
        Ok(Arc::new(View {
            first_step: problem.situation().step,
            plan,
            known,
            weights,
            rounds,
        }))
    }

    /// Gives the members of a component one view, and plans anew if they know more than the view
    /// holds.
    fn share(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        members: &[usize],
    ) -> Result<(), PlanError> {
        let known: Vec<bool> = (0..state.hotspot_count())
            .map(|hotspot| state.knows(members[0], hotspot))
            .collect();
        let mut newest = &self.views[members[0]];
        let mut agreed = true;
        for &uav in members {
            let view = &self.views[uav];
            agreed &= Arc::ptr_eq(view, newest);
            if view.first_step > newest.first_step {
                newest = view;
            }
        }
        if agreed && newest.known == known {
            return Ok(());
        }
        let view = Arc::new(self.renewed(model, state, members, newest, known)?);
        for &uav in members {
            self.views[uav] = Arc::clone(&view);
        }
        Ok(())
    }

    fn renewed(
        &self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        members: &[usize],
        shared: &View,
        known: Vec<bool>,
    ) -> Result<View, PlanError> {
        let mut situation = Situation::of(state);
        for uav in 0..state.uav_count() {
            if !members.contains(&uav) {
                situation.cells[uav] = shared.cell(state, uav);
                situation.charges_uj[uav] = model.energy().capacity_uj;
            }
        }
        let weights = belief(model, state, shared, &known)?;
        let hotspots = if weights.is_empty() {
            hotspot_cells(state)
        } else {
            Vec::new()
        };
        let targets = if weights.is_empty() {
            let unknown = (0..known.len()).filter(|&hotspot| !known[hotspot]);
            let unknown: Vec<Cell> = unknown.map(|hotspot| hotspots[hotspot]).collect();
            Targets::known(model, &unknown)?
        } else {
            let left = known.iter().filter(|known| !**known).count();
            Targets::weighted(model, left as u32, &weights)?
        };
        let problem = Problem::new(model, &targets, situation)?.only(members);
        let flown = shared.flown(state);
        let mut begin = vec![shared.plan.paths.after(flown, problem.steps())];
        if members.len() == state.uav_count() && weights.is_empty() {
            begin.extend(starts(&problem));
        }
        let mut plan = improve(&problem, begin, &self.settings, &mut go_on);
        let before = shared.rounds.as_ref();
        let rounds = faster_rounds(
            &problem,
            &hotspots,
            &known,
            before,
            &self.settings,
            &mut plan,
        );
        Ok(View {
            first_step: state.t(),
            plan,
            known,
            weights,
            rounds,
        })
    }

    fn write_members(
        &self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        members: &[usize],
        actions: &mut [f32],
    ) {
        let view = &self.views[members[0]];
        let step = view.flown(state) + 1;
        for &uav in members {
            let target = view.plan.cell(uav, step);
            let density = view.plan.pilot_density(uav, step);
            let action = &mut actions[2 * uav..2 * uav + 2];
            write(model, state.cell(uav), target, density, action);
        }
    }
}

fn go_on(_: crate::anneal::Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Returns the radio component of a UAV, in ascending order.
fn component(state: &StateRef<'_>, first: usize) -> Vec<usize> {
    let mut members = vec![first];
    let mut met = 0;
    while met < members.len() {
        for uav in state.neighbours(members[met]) {
            if !members.contains(&uav) {
                members.push(uav);
            }
        }
        met += 1;
    }
    members.sort_unstable();
    members
}

fn hotspot_cells(state: &StateRef<'_>) -> Vec<Cell> {
    let hotspots = 0..state.hotspot_count();
    hotspots
        .map(|hotspot| state.hotspot_cell(hotspot))
        .collect()
}

/// Returns rounds if they are expected to be faster than a plan, whose trajectories they replace.
fn faster_rounds(
    problem: &Problem<'_>,
    hotspots: &[Cell],
    known: &[bool],
    shared: Option<&Rounds>,
    settings: &Settings,
    plan: &mut Plan,
) -> Option<Rounds> {
    let planned = rounds::plan(problem, hotspots, known, shared, &plan.paths, settings)?;
    if planned.expected.steps >= plan.expected.steps {
        return None;
    }
    plan.paths = planned.paths;
    plan.expected = planned.expected;
    Some(planned.rounds)
}

/// Returns the prior of the hidden hotspots after the looks of a shared plan. It is empty if
/// positions are known.
fn belief(
    model: &Model<'_>,
    state: &StateRef<'_>,
    shared: &View,
    known: &[bool],
) -> Result<Vec<f64>, PlanError> {
    let mut weights = shared.weights.clone();
    if weights.is_empty() {
        return Ok(weights);
    }
    let targets = Targets::weighted(model, 1, &weights)?;
    let problem = Problem::new(model, &targets, Situation::at_reset(model))?;
    let missed = missed_after(&problem, &shared.plan.paths, shared.flown(state));
    for (&site, missed) in problem.odds.sites().iter().zip(missed) {
        weights[index_of(model, site)] = shared.weights[index_of(model, site)] * missed;
    }
    for hotspot in (0..known.len()).filter(|&hotspot| known[hotspot]) {
        weights[index_of(model, state.hotspot_cell(hotspot))] = 0.0;
    }
    Ok(weights)
}
