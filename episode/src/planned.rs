//! Policies that follow plans: from a file, made before the mission, or renewed during it.

use jcas_core::rng::derive_seed;
use jcas_core::{Cell, Model, StateRef, TargetVisibility};
use jcas_plan::{Follower, Plan, PlanError, Replanner, Settings, search, tour};
use jcas_policy::Policy;
use std::ops::ControlFlow;

/// Annealing moves of `plan` and `replan` for a search; one plan serves all missions.
pub const SEARCH_ITERATIONS: u64 = 400_000;
/// Annealing moves for known hotspots, in each mission.
pub const TOUR_ITERATIONS: u64 = 20_000;
/// Annealing moves of `replan` after each confirmation.
pub const REPLAN_ITERATIONS: u64 = 5_000;
/// Seed of the annealing.
const SEED: u64 = 1;

/// A policy that follows one plan in every mission.
#[derive(Debug)]
pub struct Planned {
    follower: Follower,
}

impl Planned {
    /// Builds a policy that follows this plan.
    #[must_use]
    pub fn new(plan: Plan) -> Self {
        Self {
            follower: Follower::new(plan),
        }
    }

    /// Plans a search of the model with [`SEARCH_ITERATIONS`].
    ///
    /// # Errors
    /// [`PlanError`], where the fleet or the grid is too large.
    pub fn search(model: &Model<'_>) -> Result<Plan, PlanError> {
        let settings = Settings {
            iterations: SEARCH_ITERATIONS,
            seed: SEED,
        };
        search(model, &settings, &mut |_| ControlFlow::Continue(()))
    }
}

impl Policy for Planned {
    fn name(&self) -> &str {
        "plan"
    }

    fn pilot(&self) -> &dyn core::fmt::Display {
        &"planned"
    }

    fn reset(&mut self, _: &Model<'_>, _: u64) {
        self.follower.reset();
    }

    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        self.follower.act(model, state, actions);
    }
}

/// A policy that plans a tour of known hotspots before each mission.
#[derive(Debug, Default)]
pub struct PlannedTour {
    follower: Option<Follower>,
    seed: u64,
}

impl Policy for PlannedTour {
    fn name(&self) -> &str {
        "plan"
    }

    fn pilot(&self) -> &dyn core::fmt::Display {
        &"planned"
    }

    fn reset(&mut self, _: &Model<'_>, seed: u64) {
        self.follower = None;
        self.seed = derive_seed(SEED, seed);
    }

    /// # Panics
    /// No plan can be made; [`checked`] reports this beforehand.
    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        let follower = self.follower.get_or_insert_with(|| {
            let hotspots: Vec<Cell> = (0..state.hotspot_count())
                .map(|hotspot| state.hotspot_cell(hotspot))
                .collect();
            let settings = Settings {
                iterations: TOUR_ITERATIONS,
                seed: self.seed,
            };
            let plan = tour(model, &hotspots, &settings, &mut |_| {
                ControlFlow::Continue(())
            });
            Follower::new(plan.expect("a plan of this model can be made"))
        });
        follower.act(model, state, actions);
    }
}

/// A policy that plans before the first step, and again after each confirmation.
#[derive(Clone, Debug)]
pub struct Replanned {
    replanner: Replanner,
}

impl Replanned {
    /// Plans for this model; where hotspots are hidden, the first plan is made here.
    ///
    /// # Errors
    /// [`PlanError`], where the fleet or the grid is too large.
    pub fn new(model: &Model<'_>) -> Result<Self, PlanError> {
        let first = match model.config().target_visibility {
            TargetVisibility::Hidden => SEARCH_ITERATIONS,
            TargetVisibility::Known => TOUR_ITERATIONS,
        };
        let settings = Settings {
            iterations: REPLAN_ITERATIONS,
            seed: SEED,
        };
        let mut replanner = Replanner::new(first, settings);
        if model.config().target_visibility == TargetVisibility::Hidden {
            replanner.prepare(model)?;
        }
        Ok(Self { replanner })
    }
}

impl Policy for Replanned {
    fn name(&self) -> &str {
        "replan"
    }

    fn pilot(&self) -> &dyn core::fmt::Display {
        &"planned"
    }

    fn reset(&mut self, _: &Model<'_>, _: u64) {
        self.replanner.reset();
    }

    /// # Panics
    /// No plan can be made; [`checked`] reports this beforehand.
    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        self.replanner
            .act(model, state, actions)
            .expect("a plan of this model can be made");
    }
}

/// Checks that plans of a model can be made.
///
/// # Errors
/// [`PlanError`], where the fleet or the grid is too large.
pub fn checked(model: &Model<'_>) -> Result<(), PlanError> {
    let targets = jcas_plan::Targets::hidden(model);
    let situation = jcas_plan::Situation::at_reset(model);
    jcas_plan::Problem::new(model, &targets, situation).map(|_| ())
}
