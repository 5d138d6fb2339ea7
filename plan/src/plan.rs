//! Plans, and the functions that make them.

use alloc::vec;
use alloc::vec::Vec;
use core::ops::ControlFlow;

use jcas_core::{Cell, Model};

use crate::anneal::{Annealer, Progress, Settings};
use crate::bound::bound_while;
use crate::error::PlanError;
use crate::objective::{Expectation, confirmed_by, expect, expect_while, stay_one};
use crate::odds::plan_densities;
use crate::paths::Paths;
use crate::problem::{Problem, Situation, check_start};
use crate::targets::Targets;
use crate::watch::Watch;
use crate::{formation, memory, teams};

/// The probabilities that all hotspots are confirmed, from which on initial trajectories gather.
const GATHERS_AT: [f64; 3] = [0.9, 0.99, 0.999];

/// Products that the bound may take after the planning was ended: some seconds at most.
const AFTER_STOP: usize = 1 << 29;

/// A plan: trajectories with their expected time.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Hash of the configuration of the plan.
    pub config_hash: u64,
    /// Seed of the annealing.
    pub seed: u64,
    /// Number of moves that the annealing tried.
    pub iterations: u64,
    /// Whether the annealing ended before the requested number of moves.
    pub stopped: bool,
    /// Number of steps of the episode before the plan begins.
    pub first_step: u32,
    /// Cells and levels of each UAV.
    pub paths: Paths,
    /// The pilot density of each level. The last level, for an empty battery, has the least
    /// density.
    pub densities: Vec<f64>,
    /// Width of the grid in cells; the row-major index of a cell is x + y times the width.
    pub grid_width: u32,
    /// The expected time of the plan.
    pub expected: Expectation,
    /// Expected steps of the best initial trajectories.
    pub start_steps: f64,
    /// A lower bound on the expected steps of every fixed plan.
    pub bound_steps: f64,
}

impl Plan {
    /// Returns a plan of these trajectories, without an annealing and a bound.
    pub(crate) fn fixed(problem: &Problem<'_>, paths: Paths, expected: Expectation) -> Self {
        Self {
            config_hash: problem.model.config_hash(),
            seed: 0,
            iterations: 0,
            stopped: false,
            first_step: problem.situation.step,
            paths,
            densities: plan_densities(problem.model),
            grid_width: problem.model.config().grid_width,
            expected,
            start_steps: expected.steps,
            bound_steps: 0.0,
        }
    }

    /// Returns the cell of a UAV after a step of the plan. From the last step on it stays there.
    #[must_use]
    pub fn cell(&self, uav: usize, step: usize) -> Cell {
        let index = self.paths.cell(uav, step);
        Cell {
            x: index % self.grid_width,
            y: index / self.grid_width,
        }
    }

    /// Returns the highest pilot density for sensing, and the least otherwise.
    pub(crate) fn density_of(&self, senses: bool) -> f64 {
        let highest = self.densities.len().saturating_sub(2);
        self.densities[if senses { highest } else { 0 }]
    }

    /// Returns the pilot density of a UAV in a step of the plan.
    #[must_use]
    pub fn pilot_density(&self, uav: usize, step: usize) -> f64 {
        self.densities[usize::from(self.paths.level(uav, step))]
    }
}

/// Plans an episode from its reset, with all hotspots hidden. Any set of distinct cells without a
/// depot is as likely as any other.
///
/// # Errors
/// [`PlanError`] if the fleet or the grid is too large, or if there is no memory for the plan.
pub fn search(
    model: &Model<'_>,
    settings: &Settings,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Plan, PlanError> {
    check_start(model)?;
    memory::check(model, None, 1)?;
    let targets = Targets::hidden(model);
    let problem = Problem::new(model, &targets, Situation::at_reset(model))?;
    Ok(planned(&problem, settings, &mut Watch::new(progress)))
}

/// Plans an episode from its reset, with hotspots in known cells. The plan decides in what order,
/// in which teams and for how long the UAVs visit them.
///
/// # Errors
/// [`PlanError`] if the fleet or the grid is too large, or if a hotspot lies off the grid. So it is
/// if there is no memory for the plan.
pub fn tour(
    model: &Model<'_>,
    hotspots: &[Cell],
    settings: &Settings,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Plan, PlanError> {
    check_start(model)?;
    memory::check(model, Some(hotspots.len()), 1)?;
    let targets = Targets::known(model, hotspots)?;
    let problem = Problem::new(model, &targets, Situation::at_reset(model))?;
    Ok(planned(&problem, settings, &mut Watch::new(progress)))
}

/// Returns initial trajectories: tours of teams if hotspots are known, else sweeps of formations.
/// Each senses at the highest pilot density or at the lowest, which links farther.
#[must_use]
pub fn starts(problem: &Problem<'_>) -> Vec<Paths> {
    starts_watched(problem, &mut Watch::new(&mut |_| ControlFlow::Continue(())))
}

fn starts_watched(problem: &Problem<'_>, watch: &mut Watch<'_>) -> Vec<Paths> {
    let mut levels = vec![0, problem.odds.highest()];
    levels.dedup();
    let mut starts = teams::tours(problem, &levels, watch);
    if starts.is_empty() {
        for level in levels {
            starts.extend(formation::sweeps(problem, level));
        }
    }
    starts
}

/// Anneals the best of the initial trajectories. If none fits, the fleet hovers. `progress` is
/// asked after each batch of moves, and before the first one after each share of the evaluations.
///
/// Trajectories fit if they have the UAVs and steps of the problem and every battery lasts.
#[must_use]
pub fn improve(
    problem: &Problem<'_>,
    starts: Vec<Paths>,
    settings: &Settings,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Plan {
    improve_watched(problem, starts, settings, &mut Watch::new(progress))
}

/// Plans from the initial trajectories of a problem.
fn planned(problem: &Problem<'_>, settings: &Settings, watch: &mut Watch<'_>) -> Plan {
    let starts = starts_watched(problem, watch);
    improve_watched(problem, starts, settings, watch)
}

/// The best trajectories so far, with their expected steps, and those that confirm all hotspots
/// first.
#[derive(Default)]
struct Best {
    steps: Option<(Expectation, Paths)>,
    confirmed: Option<(Expectation, Paths)>,
}

impl Best {
    /// Evaluates trajectories. The first ones of all are evaluated even if the planning was ended.
    fn consider(&mut self, problem: &Problem<'_>, paths: Paths, watch: &mut Watch<'_>) {
        let first = self.steps.is_none();
        let mut go_on = |products| !watch.work(products) || first;
        let Some(expected) = expect_while(problem, &paths, &mut go_on) else {
            return;
        };
        let less = |best: &Option<(Expectation, Paths)>, of: fn(&Expectation) -> f64| {
            best.as_ref()
                .is_none_or(|(least, _)| of(&expected) < of(least))
        };
        if less(&self.confirmed, |expected| expected.confirmed_steps) {
            self.confirmed = Some((expected, paths.clone()));
        }
        if less(&self.steps, |expected| expected.steps) {
            watch.found(expected.steps);
            self.steps = Some((expected, paths));
        }
    }
}

fn improve_watched(
    problem: &Problem<'_>,
    starts: Vec<Paths>,
    settings: &Settings,
    watch: &mut Watch<'_>,
) -> Plan {
    let fits = |paths: &Paths| {
        paths.uav_count() == problem.situation.cells.len()
            && paths.steps() == problem.steps
            && problem.allows(paths)
    };
    let mut best = Best::default();
    let mut starts: Vec<Paths> = starts.into_iter().filter(fits).collect();
    if problem.together && starts.iter().any(|paths| stay_one(problem, paths)) {
        starts.retain(|paths| stay_one(problem, paths));
    }
    for paths in starts {
        best.consider(problem, paths, watch);
    }
    let fastest = best.confirmed.take();
    let fastest = fastest.map_or_else(|| formation::hovering(problem), |(_, paths)| paths);
    // The end needs one radio component, so trajectories that part must gather.
    for probability in GATHERS_AT {
        if watch.stopped() && best.steps.is_some() {
            break;
        }
        let from = confirmed_by(problem, &fastest, probability);
        let paths = formation::gathered(problem, &fastest, from);
        if !problem.together || stay_one(problem, &paths) {
            best.consider(problem, paths, watch);
        }
    }
    if best.steps.is_none() {
        best.consider(problem, fastest, watch);
    }
    let (mut expected, mut paths) = best.steps.unwrap_or_default();
    let start_steps = expected.steps;
    if !watch.stopped() {
        let annealer = Annealer::new(problem, paths.clone(), settings.seed);
        let annealed = annealer.run_watched(settings.iterations, watch);
        let after = expect(problem, &annealed);
        // The annealing treats distinct hotspots as independent, which may mislead it slightly.
        if after.steps <= start_steps {
            (expected, paths) = (after, annealed);
        }
    }
    // A bound of a planning that was ended may be a lower one.
    let mut left = AFTER_STOP;
    let mut go_on = |products: usize| {
        left = left.saturating_sub(products);
        !watch.work(products) || left > 0
    };
    let bound_steps = bound_while(problem, &mut go_on);
    Plan {
        seed: settings.seed,
        iterations: watch.iterations(),
        stopped: watch.stopped() && watch.iterations() < settings.iterations,
        start_steps,
        bound_steps,
        ..Plan::fixed(problem, paths, expected)
    }
}
