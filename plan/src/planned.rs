//! Policies that follow plans: a given one, one made before the episode, or plans that are renewed.

use core::fmt;
use core::ops::ControlFlow;

use alloc::sync::Arc;
use alloc::vec::Vec;
use jcas_core::rng::derive_seed;
use jcas_core::{Cell, Model, StateRef, TargetVisibility};
use jcas_policy::memory::{Due, LastStep};
use jcas_policy::{MemoryError, MemoryReader, Policy};

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
        Ok(Planned {
            kind: self,
            way,
            last: LastStep::default(),
        })
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
    last: LastStep,
}

#[derive(Clone, Debug)]
enum Way {
    Follow(Follower),
    Tour(Tour),
    Replan(Replanner),
}

/// A tour of known hotspots. It is a function of the episode's seed and hotspots, and is kept until
/// they change.
#[derive(Clone, Debug, Default)]
struct Tour {
    follower: Option<Follower>,
    seed: u64,
    hotspots: Vec<Cell>,
}

impl Planned {
    /// Makes a policy that follows this plan in every episode.
    #[must_use]
    pub fn following(plan: impl Into<Arc<Plan>>) -> Self {
        Self {
            kind: PlannedKind::Plan,
            way: Way::Follow(Follower::new(plan)),
            last: LastStep::default(),
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
    /// [`PlanError`] if the fleet or the grid is too large, if there is no memory for a plan, or if
    /// the policy remembers another state.
    pub fn try_plan(&mut self, model: &Model<'_>, state: &StateRef<'_>) -> Result<(), PlanError> {
        match &mut self.way {
            Way::Follow(_) => Ok(()),
            Way::Tour(tour) => tour.prepare(model, state),
            Way::Replan(replanner) => {
                // Plans of a state are the same when they are made again, so to repeat is to go on.
                if self.last.due(state)? == Due::Begin {
                    self.last = LastStep::default();
                    replanner.reset();
                }
                replanner.try_plan(model, state)?;
                self.last = LastStep::at(state);
                Ok(())
            }
        }
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
        let cells = (0..state.hotspot_count()).map(|hotspot| state.hotspot_cell(hotspot));
        let seed = derive_seed(SEED, state.seed());
        let same = self.seed == seed && cells.clone().eq(self.hotspots.iter().copied());
        if same && self.follower.is_some() {
            return Ok(());
        }
        self.follower = None;
        memory::check(model, Some(state.hotspot_count()), 1)?;
        let hotspots: Vec<Cell> = cells.collect();
        let settings = Settings {
            iterations: TOUR_ITERATIONS,
            seed,
        };
        let plan = tour(model, &hotspots, &settings, &mut go_on)?;
        *self = Self {
            follower: Some(Follower::new(plan)),
            seed,
            hotspots,
        };
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

    fn reset(&mut self, _: &Model<'_>, _: u64) {
        self.last = LastStep::default();
        match &mut self.way {
            Way::Follow(_) => {}
            Way::Tour(tour) => *tour = Tour::default(),
            Way::Replan(replanner) => replanner.reset(),
        }
    }

    fn remembers(&self) -> bool {
        matches!(self.way, Way::Replan(_))
    }

    fn save_memory(&self, write: &mut dyn FnMut(u64)) {
        if let Way::Replan(replanner) = &self.way {
            self.last.save(write);
            if self.last.is_some() {
                replanner.save(write);
            }
        }
    }

    fn load_memory(
        &mut self,
        model: &Model<'_>,
        read: &mut MemoryReader<'_>,
    ) -> Result<(), MemoryError> {
        let Way::Replan(replanner) = &mut self.way else {
            return read.end();
        };
        let last = LastStep::load(read)?;
        if last.is_some() {
            let known = model.config().target_visibility == TargetVisibility::Known;
            let hotspots = known.then(|| model.hotspot_count());
            memory::check(model, hotspots, model.uav_count())
                .map_err(|_| MemoryError::OutOfMemory)?;
            let loaded = replanner.load(model, read)?;
            read.end()?;
            *replanner = loaded;
        } else {
            read.end()?;
            replanner.reset();
        }
        self.last = last;
        Ok(())
    }

    /// # Panics
    /// It panics if no plan can be made, which [`PlannedKind::build`] reports before, or if the
    /// policy remembers another state; [`Planned::try_plan`] does not.
    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        self.try_plan(model, state)
            .expect("a plan of this model can be made");
        self.write(model, state, actions);
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use jcas_core::{Config, Preset, Sim};

    use super::*;

    const FEW: Settings = Settings {
        iterations: 300,
        seed: 1,
    };

    fn replan(model: &Model<'_>) -> Planned {
        let mut replanner = Replanner::new(300, FEW);
        if model.config().target_visibility == TargetVisibility::Hidden {
            replanner.prepare(model).unwrap();
        }
        Planned {
            kind: PlannedKind::Replan,
            way: Way::Replan(replanner),
            last: LastStep::default(),
        }
    }

    fn saved(policy: &Planned) -> Vec<u64> {
        let mut words = Vec::new();
        policy.save_memory(&mut |word| words.push(word));
        words
    }

    fn load(policy: &mut Planned, model: &Model<'_>, words: &[u64]) -> Result<(), MemoryError> {
        policy.load_memory(model, &mut MemoryReader::new(words))
    }

    /// Flies an episode, and then its steps from a memory of each of its states. A state from
    /// before is refused without its memory.
    #[test]
    fn a_loaded_memory_replans_alike() {
        for preset in [Preset::Mission, Preset::Search, Preset::Isac] {
            let config = Config {
                uav_count: 8,
                hotspot_count: 3,
                grid_width: 9,
                horizon_steps: 40,
                ..Config::preset(preset)
            };
            let model = Model::new(config).unwrap();
            let mut policy = replan(&model);
            let fresh = replan(&model);
            let mut actions = vec![0.0; model.action_len()];
            let mut sim = Sim::new(&model);
            sim.reset(4);
            let mut pasts = Vec::new();
            while !sim.state().terminated() && !sim.state().truncated() {
                pasts.push((sim.clone(), saved(&policy)));
                policy.act(&model, &sim.state(), &mut actions);
                sim.step(&actions).unwrap();
            }
            let hashes: Vec<u64> = pasts.iter().map(|(sim, _)| sim.state_hash()).collect();
            if pasts.len() > 3 {
                let refused = policy.try_plan(&model, &pasts[2].0.state());
                assert!(matches!(refused, Err(PlanError::Memory(_))), "{refused:?}");
            }
            for (index, (past, memory)) in pasts.iter().enumerate().step_by(3) {
                let (mut sim, mut again) = (past.clone(), fresh.clone());
                load(&mut again, &model, memory).unwrap();
                load(&mut policy, &model, memory).unwrap();
                assert_eq!(saved(&again), *memory);
                for hash in &hashes[index..hashes.len().min(index + 4)] {
                    assert_eq!(sim.state_hash(), *hash, "{preset:?} {index}");
                    policy.act(&model, &sim.state(), &mut actions);
                    let expected = actions.clone();
                    again.act(&model, &sim.state(), &mut actions);
                    assert_eq!(actions, expected);
                    sim.step(&actions).unwrap();
                }
            }
        }
    }

    /// Each word of a memory that was changed is refused, or gives a plan that can be executed.
    #[test]
    fn no_words_make_a_planner_panic() {
        let model = Model::new(Config {
            uav_count: 4,
            hotspot_count: 3,
            grid_width: 8,
            grid_height: 8,
            horizon_steps: 20,
            ..Config::preset(Preset::Isac)
        })
        .unwrap();
        let mut policy = replan(&model);
        let mut actions = vec![0.0; model.action_len()];
        let mut sim = Sim::new(&model);
        sim.reset(4);
        for _ in 0..2 {
            policy.act(&model, &sim.state(), &mut actions);
            sim.step(&actions).unwrap();
        }
        let memory = saved(&policy);
        for at in (0..memory.len()).step_by(3) {
            let value = [0, 1, 3, 1 << 32, u64::MAX][at % 5];
            let mut changed = memory.clone();
            changed[at] = value;
            if load(&mut policy, &model, &changed).is_ok()
                && policy.try_plan(&model, &sim.state()).is_ok()
            {
                policy.write(&model, &sim.state(), &mut actions);
            }
            changed.truncate(at);
            assert!(load(&mut policy, &model, &changed).is_err());
        }
    }
}
