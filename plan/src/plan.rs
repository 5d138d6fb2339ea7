//! Plans, and the functions that make them.

use alloc::vec;
use alloc::vec::Vec;
use core::ops::ControlFlow;

use jcas_core::{Cell, Model};

use crate::anneal::{Annealer, Progress, Settings};
use crate::bound::bound;
use crate::error::PlanError;
use crate::objective::{Expectation, confirmed_by, expect, stay_one};
use crate::paths::Paths;
use crate::problem::{Problem, Situation, check_start};
use crate::targets::Targets;
use crate::{formation, memory, teams};

/// The probabilities that all hotspots are confirmed, from which on initial trajectories gather.
const GATHERS_AT: [f64; 3] = [0.9, 0.99, 0.999];

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
    /// Returns the cell of a UAV after a step of the plan. From the last step on it stays there.
    #[must_use]
    pub fn cell(&self, uav: usize, step: usize) -> Cell {
        let index = self.paths.cell(uav, step);
        Cell {
            x: index % self.grid_width,
            y: index / self.grid_width,
        }
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
    Ok(improve(&problem, starts(&problem), settings, progress))
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
    Ok(improve(&problem, starts(&problem), settings, progress))
}

/// Returns initial trajectories: tours of teams if hotspots are known, else sweeps of formations.
/// Each senses at the highest pilot density or at the lowest, which links farther.
#[must_use]
pub fn starts(problem: &Problem<'_>) -> Vec<Paths> {
    let mut levels = vec![0, problem.odds.highest()];
    levels.dedup();
    let mut starts = teams::tours(problem, &levels);
    if starts.is_empty() {
        for level in levels {
            starts.extend(formation::sweeps(problem, level));
        }
    }
    starts
}

/// Anneals the best of the initial trajectories. If none fits, the fleet hovers.
///
/// Trajectories fit if they have the UAVs and steps of the problem and every battery lasts.
#[must_use]
pub fn improve(
    problem: &Problem<'_>,
    starts: Vec<Paths>,
    settings: &Settings,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Plan {
    let fits = |paths: &Paths| {
        paths.uav_count() == problem.situation.cells.len()
            && paths.steps() == problem.steps
            && problem.allows(paths)
    };
    let mut best = (f64::INFINITY, Paths::default());
    let mut fastest = best.clone();
    let mut starts: Vec<Paths> = starts.into_iter().filter(fits).collect();
    if problem.together && starts.iter().any(|paths| stay_one(problem, paths)) {
        starts.retain(|paths| stay_one(problem, paths));
    }
    for paths in starts {
        let expected = expect(problem, &paths);
        if expected.confirmed_steps < fastest.0 {
            fastest = (expected.confirmed_steps, paths.clone());
        }
        if expected.steps < best.0 {
            best = (expected.steps, paths);
        }
    }
    if fastest.0.is_infinite() {
        fastest.1 = formation::hovering(problem);
    }
    // The end needs one radio component, so trajectories that part must gather.
    for probability in GATHERS_AT {
        let from = confirmed_by(problem, &fastest.1, probability);
        let paths = formation::gathered(problem, &fastest.1, from);
        let steps = expect(problem, &paths).steps;
        if steps < best.0 && (!problem.together || stay_one(problem, &paths)) {
            best = (steps, paths);
        }
    }
    let (start_steps, paths) = best;
    let mut tried = 0;
    let annealer = Annealer::new(problem, paths.clone(), settings.seed);
    let (annealed, stopped) = annealer.run(settings.iterations, &mut |report| {
        tried = report.iterations;
        progress(report)
    });
    let mut expected = expect(problem, &annealed);
    let mut best = annealed;
    if expected.steps > start_steps {
        // The annealing treats distinct hotspots as independent, which may mislead it slightly.
        expected = expect(problem, &paths);
        best = paths;
    }
    let mut densities = problem.odds.densities().to_vec();
    densities.push(problem.model.config().pilot_density_min);
    Plan {
        config_hash: problem.model.config_hash(),
        seed: settings.seed,
        iterations: tried,
        stopped,
        first_step: problem.situation.step,
        paths: best,
        densities,
        grid_width: problem.model.config().grid_width,
        expected,
        start_steps,
        bound_steps: bound(problem),
    }
}
