//! A policy that plans anew during an episode: after each confirmation, meeting and report.

use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::ControlFlow;

use jcas_core::{Cell, Model, StateRef, TargetVisibility};

use crate::anneal::Settings;
use crate::belief::{self, Look, Looks};
use crate::error::PlanError;
use crate::follow::write;
use crate::memory;
use crate::plan::{Plan, improve, starts};
use crate::problem::{Problem, Situation, check_start};
use crate::rounds::{self, Rounds};
use crate::targets::Targets;

/// A planner that plans before the first step, and anew in each radio component whose knowledge has
/// changed.
///
/// A component plans for its members by what they know. That is their own cells, charges and looks,
/// the hotspots and the reports that they know, and the plan that they share with the others. It
/// assumes that the others follow that plan. All members compute the same plan, bit by bit.
///
/// Hidden hotspots lie where the looks and the reports make them likely, as `belief.rs` says.
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
    /// The looks of each UAV so far, step by step.
    looks: Vec<Vec<Look>>,
    /// For each UAV, how many looks of each other one it has been told of.
    told: Vec<Vec<usize>>,
}

/// A plan as the members of a component share it.
#[derive(Clone, Debug)]
struct View {
    first_step: u32,
    plan: Plan,
    /// The hotspots that the members knew when they planned.
    known: Vec<bool>,
    /// The rounds that the plan begins, where they are faster than fixed trajectories.
    rounds: Option<Rounds>,
    /// The reports that the members knew when they planned.
    reports: Vec<u64>,
    /// Whether positions are hidden, so that the first plan serves all episodes.
    hidden: bool,
    /// For each UAV, the looks from the last contact with it to the plan's beginning, as the plans
    /// before had them. There are none before the first step.
    assumed: Vec<Vec<Look>>,
}

impl View {
    fn flown(&self, state: &StateRef<'_>) -> usize {
        state.t().saturating_sub(self.first_step) as usize
    }

    /// Returns the cell of a UAV in the plan now.
    fn cell(&self, state: &StateRef<'_>, uav: usize) -> Cell {
        self.plan.cell(uav, self.flown(state))
    }

    /// Returns the last looks of a UAV, as the plans have them.
    fn assumed(&self, state: &StateRef<'_>, uav: usize, count: usize) -> Vec<Look> {
        let mut looks = self.assumed.get(uav).cloned().unwrap_or_default();
        looks.extend((1..=self.flown(state)).map(|step| Look {
            cell: self.plan.cell(uav, step),
            level: self.plan.paths.level(uav, step),
        }));
        looks.split_off(looks.len().saturating_sub(count))
    }

    /// Whether the members plan anew only if they know more than this.
    fn holds(&self, known: &[bool], reports: &[u64]) -> bool {
        // Before the first step there are no reports.
        let planned = self.reports.iter().chain(core::iter::repeat(&0));
        self.known == known && reports.iter().zip(planned).all(|(now, then)| now == then)
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
            looks: Vec::new(),
            told: Vec::new(),
        }
    }

    /// Called before the first step of an episode.
    pub fn reset(&mut self) {
        // With hidden hotspots, the first plan is the same in every episode.
        self.first = self.first.take().filter(|view| view.hidden);
        self.views.clear();
        self.looks.clear();
        self.told.clear();
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
        if hidden {
            self.record(state);
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
        let rounds = faster_rounds(&problem, hotspots, &known, None, &settings, &mut plan);
        Ok(Arc::new(View {
            first_step: problem.situation().step,
            plan,
            known,
            rounds,
            reports: Vec::new(),
            hidden: model.config().target_visibility == TargetVisibility::Hidden,
            assumed: Vec::new(),
        }))
    }

    /// Records where each UAV is in the step that has just ended.
    fn record(&mut self, state: &StateRef<'_>) {
        self.looks.resize(state.uav_count(), Vec::new());
        let first = self.first.as_ref().map(|view| &view.plan);
        let densities = first.map_or(&[][..], |plan| &plan.densities[..]);
        for (uav, looks) in self.looks.iter_mut().enumerate() {
            let level = if state.grounded(uav) {
                densities.len().saturating_sub(1)
            } else {
                nearest(densities, state.pilot_density(uav))
            };
            let look = Look {
                cell: state.cell(uav),
                level: level as u8,
            };
            looks.resize(state.t() as usize, look);
        }
        self.told
            .resize(state.uav_count(), vec![0; state.uav_count()]);
    }

    /// Tells the members of a component each other's looks, and what each was told before.
    fn tell(&mut self, members: &[usize]) {
        let mut told = self.told[members[0]].clone();
        for &member in members {
            for (told, one) in told.iter_mut().zip(&self.told[member]) {
                *told = (*told).max(*one);
            }
        }
        for &member in members {
            told[member] = self.looks[member].len();
        }
        for &member in members {
            self.told[member].clone_from(&told);
        }
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
            self.tell(members);
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
        if agreed && newest.holds(&known, state.reports_of(members[0])) {
            return Ok(());
        }
        let view = Arc::new(self.renewed(model, state, members, newest, known)?);
        for &uav in members {
            self.views[uav] = Arc::clone(&view);
        }
        Ok(())
    }

    /// Returns the looks of each UAV since the last contact with it, as a shared plan has them.
    fn assumed(&self, state: &StateRef<'_>, members: &[usize], shared: &View) -> Vec<Vec<Look>> {
        let looks = self.looks.iter().zip(&self.told[members[0]]).enumerate();
        looks
            .map(|(uav, (looks, &told))| shared.assumed(state, uav, looks.len() - told))
            .collect()
    }

    /// Returns what the members of a component know about the looks of each UAV.
    fn looks_of<'l>(&'l self, members: &[usize], assumed: &'l [Vec<Look>]) -> Vec<Looks<'l>> {
        let looks = self.looks.iter().zip(&self.told[members[0]]);
        looks
            .zip(assumed)
            .map(|((looks, &told), assumed)| Looks {
                heard: &looks[..told],
                assumed,
            })
            .collect()
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
            assumed = self.assumed(state, members, shared);
            let looks = self.looks_of(members, &assumed);
            let chances = belief::chances(model, state, members[0], &known, &looks);
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
        let flown = shared.flown(state);
        let mut begin = vec![shared.plan.paths.after(flown, problem.steps())];
        if members.len() == state.uav_count() && !shared.hidden {
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
        let step = view.flown(state) + 1;
        for &uav in members {
            let target = view.plan.cell(uav, step);
            let density = view.plan.pilot_density(uav, step);
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

/// Returns the level of the nearest density; the last one stands for an empty battery.
fn nearest(densities: &[f64], density: f64) -> usize {
    let distance = |level: &usize| (densities[*level] - density).abs();
    let levels = 0..densities.len().saturating_sub(1);
    levels
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap_or(0)
}
