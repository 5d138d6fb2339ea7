//! A policy that plans anew during an episode: after each confirmation, meeting and report.

use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::ControlFlow;

use jcas_core::{Cell, Model, StateRef, TargetVisibility};
use jcas_policy::{MemoryError, MemoryReader};

use crate::alone;
use crate::anneal::Settings;
use crate::belief;
use crate::error::PlanError;
use crate::follow::write;
use crate::gossip::Gossip;
use crate::memory;
use crate::objective::runs_out;
use crate::odds::plan_densities;
use crate::plan::{Plan, improve, starts};
use crate::problem::{Problem, Situation, check_start};
use crate::rounds::{self, Rounds};
use crate::targets::Targets;
use crate::view::View;

/// A planner that plans before the first step, and anew in each radio component whose knowledge has
/// changed.
///
/// A component plans for its members by what they know. That is their own cells, charges and
/// observations, the hotspots and the reports that they know, and the plan that they share with the
/// others. It assumes that the others follow that plan. All members compute the same plan, bit by
/// bit.
///
/// Hidden hotspots lie where the observations and the reports make them likely, as `belief.rs`
/// says.
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
    gossip: Gossip,
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
            gossip: Gossip::default(),
        }
    }

    /// Forgets everything, as before the first step of an episode.
    pub fn reset(&mut self) {
        // With hidden hotspots, the first plan is the same in every episode.
        self.first = self.first.take().filter(|view| view.hidden);
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
            self.gossip.begin(state);
            self.first = Some(first);
        }
        if hidden {
            let first = self.first.as_ref().map(|view| &view.plan);
            let densities = first.map_or(&[][..], |plan| &plan.densities[..]);
            self.gossip.record(state, densities);
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

    pub(crate) fn save(&self, write: &mut dyn FnMut(u64)) {
        let mut distinct: Vec<&Arc<View>> = Vec::new();
        let mut place_of_uav = Vec::new();
        for view in &self.views {
            let place = distinct.iter().position(|other| Arc::ptr_eq(other, view));
            place_of_uav.push(place.unwrap_or(distinct.len()));
            if place.is_none() {
                distinct.push(view);
            }
        }
        write(distinct.len() as u64);
        distinct.iter().for_each(|view| view.save(write));
        place_of_uav.iter().for_each(|&place| write(place as u64));
        self.gossip.save(write);
    }

    /// Reads what [`Replanner::save`] wrote.
    pub(crate) fn load(
        &self,
        model: &Model<'_>,
        read: &mut MemoryReader<'_>,
    ) -> Result<Self, MemoryError> {
        let densities = plan_densities(model);
        let count = read.count()?;
        if count == 0 || count > model.uav_count() {
            return Err(MemoryError::Corrupt);
        }
        let mut distinct = Vec::with_capacity(count);
        for _ in 0..count {
            distinct.push(Arc::new(View::load(read, model, &densities)?));
        }
        let mut views = Vec::with_capacity(model.uav_count());
        for _ in 0..model.uav_count() {
            views.push(Arc::clone(&distinct[read.index(count)?]));
        }
        Ok(Self {
            first: self.first.clone(),
            views,
            components: Vec::new(),
            gossip: Gossip::load(read, model, densities.len())?,
            ..*self
        })
    }

    /// Makes the first plan, which is the same in every episode if hotspots are hidden.
    ///
    /// # Errors
    /// [`PlanError`], where the fleet or the grid is too large, or where there is no memory for a
    /// plan.
    pub fn prepare(&mut self, model: &Model<'_>) -> Result<(), PlanError> {
        check_start(model)?;
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
        let problem = Problem::new(model, targets, situation)?.together(shares_reports(model));
        let settings = Settings {
            iterations: self.first_iterations,
            ..self.settings
        };
        let mut plan = improve(&problem, starts(&problem), &settings, &mut go_on);
        let known = vec![false; model.hotspot_count()];
        let (rounds, ends_step) =
            faster_rounds(&problem, hotspots, &known, None, &settings, &mut plan);
        Ok(Arc::new(View {
            first_step: problem.situation().step,
            ends_step,
            alone: false,
            plan,
            known,
            rounds,
            reports: Vec::new(),
            hidden: model.config().target_visibility == TargetVisibility::Hidden,
            assumed: Vec::new(),
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
        if self.views[members[0]].hidden {
            self.gossip.exchange(members);
        }
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
        let run_out = newest.has_run_out(state);
        if agreed && !run_out && newest.holds(&known, state.reports_of(members[0])) {
            return Ok(());
        }
        let parted = members.len() < state.uav_count() && !newest.hidden;
        let view = Arc::new(if parted && (run_out || newest.alone) {
            alone::plan(model, state, members, known, &self.settings)?
        } else {
            self.renewed(model, state, members, newest, known)?
        });
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
        let (mut assumed, mut hotspots) = (Vec::new(), Vec::new());
        let targets = if shared.hidden {
            let missing = self.gossip.missing(members[0]).enumerate();
            assumed = missing
                .map(|(uav, count)| shared.assumed(state, uav, count))
                .collect();
            let observations = self.gossip.known_to(members[0], &assumed);
            let chances = belief::chances(model, state, members[0], &known, &observations);
            Targets::each_cell(model, &chances)?
        } else {
            hotspots = hotspot_cells(state);
            let unknown = (0..known.len()).filter(|&hotspot| !known[hotspot]);
            let unknown: Vec<Cell> = unknown.map(|hotspot| hotspots[hotspot]).collect();
            Targets::known(model, &unknown)?
        };
        let problem = Problem::new(model, &targets, situation)?
            .only(members)
            .together(shares_reports(model));
        let elapsed = shared.elapsed(state);
        let mut begin = vec![shared.plan.paths.after(elapsed, problem.steps())];
        if members.len() == state.uav_count() && !shared.hidden {
            begin.extend(starts(&problem));
        }
        let mut plan = improve(&problem, begin, &self.settings, &mut go_on);
        let before = shared.rounds.as_ref();
        let (rounds, ends_step) = faster_rounds(
            &problem,
            &hotspots,
            &known,
            before,
            &self.settings,
            &mut plan,
        );
        Ok(View {
            first_step: state.t(),
            ends_step,
            alone: false,
            plan,
            known,
            rounds,
            reports: state.reports_of(members[0]).to_vec(),
            hidden: shared.hidden,
            assumed,
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
        let step = view.elapsed(state) + 1;
        let hotspots = hotspot_cells(state);
        for &uav in members {
            let at = (state.cell(uav), state.battery_uj(uav));
            let rounds = view.rounds.as_ref();
            let order = rounds.and_then(|rounds| rounds.order(model, &hotspots, uav, at));
            let (target, density) = match order {
                Some((target, senses)) => (target, view.plan.density_of(senses)),
                None => (
                    view.plan.cell(uav, step),
                    view.plan.pilot_density(uav, step),
                ),
            };
            let action = &mut actions[2 * uav..2 * uav + 2];
            write(model, state.cell(uav), target, density, action);
        }
    }
}

/// Returns whether what one UAV sees helps the others, so that the fleet stays together.
fn shares_reports(model: &Model<'_>) -> bool {
    model.config().report_levels > 0
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

pub(crate) fn hotspot_cells(state: &StateRef<'_>) -> Vec<Cell> {
    let hotspots = 0..state.hotspot_count();
    hotspots
        .map(|hotspot| state.hotspot_cell(hotspot))
        .collect()
}

/// Returns rounds if they are expected to be as fast as a plan, whose trajectories they replace.
/// Returns also the step at which the plan has run out.
fn faster_rounds(
    problem: &Problem<'_>,
    hotspots: &[Cell],
    known: &[bool],
    shared: Option<&Rounds>,
    settings: &Settings,
    plan: &mut Plan,
) -> (Option<Rounds>, u32) {
    let now = problem.situation.step;
    let others = rounds::others(&problem.movers, shared, problem.situation.cells.len());
    let planned = others
        .and_then(|others| rounds::plan(problem, hotspots, known, &others, &plan.paths, settings));
    match planned {
        Some(planned) if planned.expected.steps <= plan.expected.steps => {
            plan.paths = planned.paths;
            plan.expected = planned.expected;
            (Some(planned.rounds), now + planned.longest)
        }
        _ => (None, now + runs_out(problem, &plan.paths)),
    }
}
