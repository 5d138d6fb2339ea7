//! Plans, and the two functions that make one.

use alloc::vec::Vec;
use core::ops::ControlFlow;

use jcas_core::{Cell, Model};

use crate::anneal::{Annealer, Progress, Settings};
use crate::bound::bound;
use crate::error::PlanError;
use crate::objective::{Expectation, expect};
use crate::paths::Paths;
use crate::problem::{Problem, Situation};
use crate::targets::Targets;
use crate::{formation, teams};

/// Trajectories with what they are expected to take.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Hash of the configuration that it was made for.
    pub config_hash: u64,
    /// Seed of the annealing.
    pub seed: u64,
    /// Moves that the annealing tried.
    pub iterations: u64,
    /// Whether the annealing was ended before the moves that were asked for.
    pub stopped: bool,
    /// Steps flown before the plan begins.
    pub first_step: u32,
    /// Cells and levels of each UAV.
    pub paths: Paths,
    /// The pilot density of each level; the last, for an empty battery, is the least.
    pub densities: Vec<f64>,
    /// Width of the grid, by which cells become indices.
    pub grid_width: u32,
    /// What the plan is expected to take.
    pub expected: Expectation,
    /// What the best trajectories to begin with were expected to take.
    pub start_steps: f64,
    /// What every fixed plan takes at least, in expectation.
    pub bound_steps: f64,
}

impl Plan {
    /// Where a UAV is after a step of the plan; from the last step on it stays.
    #[must_use]
    pub fn cell(&self, uav: usize, step: usize) -> Cell {
        let index = self.paths.cell(uav, step);
        Cell {
            x: index % self.grid_width,
            y: index / self.grid_width,
        }
    }

    /// The pilot density of a UAV in a step of the plan.
    #[must_use]
    pub fn pilot_density(&self, uav: usize, step: usize) -> f64 {
        self.densities[usize::from(self.paths.level(uav, step))]
    }
}

/// Plans a mission from its reset, with all hotspots hidden: any set of distinct cells without a
/// depot is as likely as any other.
///
/// # Errors
/// [`PlanError`], where the fleet or the grid is too large.
pub fn search(
    model: &Model<'_>,
    settings: &Settings,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Plan, PlanError> {
    let targets = Targets::hidden(model);
    let problem = Problem::new(model, &targets, Situation::at_reset(model))?;
    Ok(improve(&problem, starts(&problem), settings, progress))
}

/// Plans a mission from its reset, with hotspots in known cells: where each UAV goes, with which
/// others, in what order and for how long.
///
/// # Errors
/// [`PlanError`], where the fleet or the grid is too large or a hotspot lies off the grid.
pub fn tour(
    model: &Model<'_>,
    hotspots: &[Cell],
    settings: &Settings,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Plan, PlanError> {
    let targets = Targets::known(model, hotspots)?;
    let problem = Problem::new(model, &targets, Situation::at_reset(model))?;
    Ok(improve(&problem, starts(&problem), settings, progress))
}

/// Trajectories to begin with: tours of teams where hotspots are known, sweeps of formations where
/// they are hidden.
#[must_use]
pub fn starts(problem: &Problem<'_>) -> Vec<Paths> {
    let tours = teams::tours(problem);
    if tours.is_empty() {
        formation::sweeps(problem)
    } else {
        tours
    }
}

/// Anneals the best of some trajectories; the fleet hovers where none fits.
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
    let mut best: Option<(f64, Paths)> = None;
    for paths in starts {
        if fits(&paths) {
            let steps = expect(problem, &paths).steps;
            if best.as_ref().is_none_or(|(least, _)| steps < *least) {
                best = Some((steps, paths));
            }
        }
    }
    let (start_steps, paths) = best.unwrap_or_else(|| {
        let paths = formation::hovering(problem);
        (expect(problem, &paths).steps, paths)
    });
    let mut tried = 0;
    let annealer = Annealer::new(problem, paths.clone(), settings.seed);
    let (annealed, stopped) = annealer.run(settings.iterations, &mut |report| {
        tried = report.iterations;
        progress(report)
    });
    let mut expected = expect(problem, &annealed);
    let mut best = annealed;
    if expected.steps > start_steps {
        // The annealing takes distinct hotspots for independent ones, which may mislead it by a
        // little.
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
