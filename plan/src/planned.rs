//! Policies that follow plans: a given one, one made before the episode, or plans that are renewed.

use core::fmt;
use core::ops::ControlFlow;

use alloc::sync::Arc;
use alloc::vec::Vec;
use jcas_core::rng::derive_seed;
use jcas_core::{Cell, Model, StateRef, TargetVisibility};
use jcas_policy::Policy;

use crate::anneal::Settings;
use crate::error::PlanError;
use crate::follow::Follower;
use crate::memory;
use crate::plan::{Plan, search, tour};
use crate::problem::check_start;
use crate::replan::Replanner;

/// Annealing moves of `plan` and `replan` for a search; one plan serves all episodes.
pub const SEARCH_ITERATIONS: u64 = 400_000;
/// Annealing moves for known hotspots, in each episode.
pub const TOUR_ITERATIONS: u64 = 20_000;
/// Annealing moves of `replan` after each confirmation.
pub const REPLAN_ITERATIONS: u64 = 5_000;
/// Annealing moves of `replan` where UAVs report what they see.
pub const REPORT_ITERATIONS: u64 = 10_000;
/// Seed of the annealing.
const SEED: u64 = 1;

/// A policy that plans by itself, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlannedKind {
    /// One plan for all episodes of a search, or one for each episode with known hotspots.
    Plan,
    /// A plan before the first step, and another one after each confirmation, meeting and report.
    Replan,
}

impl PlannedKind {
    /// All policies that plan.
    pub const ALL: [Self; 2] = [Self::Plan, Self::Replan];

    /// The name of the policy.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Plan => jcas_policy::PLAN.name,
            Self::Replan => jcas_policy::REPLAN.name,
        }
    }

    /// Returns the policy of this name, if there is one.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Builds the policy. If hotspots are hidden, the plan of the first step is made here, in
    /// [`SEARCH_ITERATIONS`].
    ///
    /// # Errors
    /// [`PlanError`] if the fleet or the grid is too large, or if there is no memory for a plan.
    pub fn build(self, model: &Model<'_>) -> Result<Planned, PlanError> {
        self.build_in(model, SEARCH_ITERATIONS)
    }

    /// Builds the policy as [`PlannedKind::build`] does, with another number of moves for the plan
    /// of a search.
    ///
    /// # Errors
    /// As [`PlannedKind::build`].
    pub fn build_in(self, model: &Model<'_>, iterations: u64) -> Result<Planned, PlanError> {
        let hidden = model.config().target_visibility == TargetVisibility::Hidden;
        if hidden || self == Self::Plan {
            check_start(model)?;
        }
        if !hidden {
            memory::check(model, Some(model.hotspot_count()), model.uav_count())?;
        }
        let way = match self {
            Self::Plan if hidden => {
                let plan = search(model, &settings(iterations), &mut go_on)?;
                Way::Follow(Follower::new(plan))
            }
            Self::Plan => Way::Tour(Tour::default()),
            Self::Replan if hidden => {
                let renewals = if model.config().report_levels > 0 {
                    REPORT_ITERATIONS
                } else {
                    REPLAN_ITERATIONS
                };
                let mut replanner = Replanner::new(iterations, settings(renewals));
                replanner.prepare(model)?;
                Way::Replan(replanner)
            }
            Self::Replan => {
                Way::Replan(Replanner::new(TOUR_ITERATIONS, settings(REPLAN_ITERATIONS)))
            }
        };
        Ok(Planned { kind: self, way })
    }
}

impl fmt::Display for PlannedKind {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}

const fn settings(iterations: u64) -> Settings {
    Settings {
        iterations,
        seed: SEED,
    }
}

fn go_on(_: crate::anneal::Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// A policy that follows plans. A plan chooses the pilot densities too.
#[derive(Clone, Debug)]
pub struct Planned {
    kind: PlannedKind,
    way: Way,
}

#[derive(Clone, Debug)]
enum Way {
    Follow(Follower),
    Tour(Tour),
    Replan(Replanner),
}

/// A tour of known hotspots, planned before the first step of each episode.
#[derive(Clone, Debug, Default)]
struct Tour {
    follower: Option<Follower>,
    seed: u64,
}

impl Planned {
    /// Makes a policy that follows this plan in every episode.
    #[must_use]
    pub fn following(plan: impl Into<Arc<Plan>>) -> Self {
        Self {
            kind: PlannedKind::Plan,
            way: Way::Follow(Follower::new(plan)),
        }
    }

    /// Returns the plan that the policy follows at present. `replan` has one for each radio
    /// component; it returns that of the first UAV. There is none before the first step of a tour.
    #[must_use]
    pub fn plan(&self) -> Option<&Plan> {
        self.plan_of(0)
    }

    /// Returns the plan that a UAV follows at present, as [`Planned::plan`] does for the first.
    #[must_use]
    pub fn plan_of(&self, uav: usize) -> Option<&Plan> {
        match &self.way {
            Way::Follow(follower) => Some(follower.plan()),
            Way::Tour(tour) => tour.follower.as_ref().map(Follower::plan),
            Way::Replan(replanner) => replanner.plan_of(uav),
        }
    }

    /// Decides a step: makes the plans that are due. This is the part that takes time and memory.
    ///
    /// # Errors
    /// [`PlanError`] if the fleet or the grid is too large, or if there is no memory for a plan.
    pub fn try_plan(&mut self, model: &Model<'_>, state: &StateRef<'_>) -> Result<(), PlanError> {
        match &mut self.way {
            Way::Follow(_) => {}
            Way::Tour(tour) => tour.prepare(model, state)?,
            Way::Replan(replanner) => replanner.try_plan(model, state)?,
        }
        Ok(())
    }

    /// Writes the actions that [`Planned::try_plan`] has just decided in this state: (u_dir,
    /// u_pilot) of each UAV, each in [-1, 1].
    pub fn write(&self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        match &self.way {
            Way::Follow(follower)
            | Way::Tour(Tour {
                follower: Some(follower),
                ..
            }) => follower.write(model, state, actions),
            Way::Tour(_) => {}
            Way::Replan(replanner) => replanner.write(model, state, actions),
        }
    }
}

impl Tour {
    /// Makes the tour, unless there is one.
    fn prepare(&mut self, model: &Model<'_>, state: &StateRef<'_>) -> Result<(), PlanError> {
        if self.follower.is_some() {
            return Ok(());
        }
        memory::check(model, Some(state.hotspot_count()), 1)?;
        let hotspots: Vec<Cell> = (0..state.hotspot_count())
            .map(|hotspot| state.hotspot_cell(hotspot))
            .collect();
        let settings = Settings {
            iterations: TOUR_ITERATIONS,
            seed: self.seed,
        };
        let plan = tour(model, &hotspots, &settings, &mut go_on)?;
        self.follower = Some(Follower::new(plan));
        Ok(())
    }
}

impl Policy for Planned {
    fn name(&self) -> &str {
        self.kind.name()
    }

    fn pilot(&self) -> &dyn fmt::Display {
        &"planned"
    }

    fn reset(&mut self, _: &Model<'_>, seed: u64) {
        match &mut self.way {
            Way::Follow(_) => {}
            Way::Tour(tour) => {
                *tour = Tour {
                    follower: None,
                    seed: derive_seed(SEED, seed),
                }
            }
            Way::Replan(replanner) => replanner.reset(),
        }
    }

    /// # Panics
    /// It panics if no plan can be made, which [`PlannedKind::build`] reports before.
    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        self.try_plan(model, state)
            .expect("a plan of this model can be made");
        self.write(model, state, actions);
    }
}
