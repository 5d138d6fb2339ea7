//! Initial trajectories for hidden hotspots: lines of UAVs abreast that sweep the grid.

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::Cell;
use jcas_core::motion::{destination, toward};
use jcas_policy::charge_to_leave_uj;
use jcas_policy::geometry::{Formation, LINES_MAX, Rank, THIRDS_MAX, meeting_cell};

use crate::battery::{Duty, after, duty};
use crate::paths::Paths;
use crate::problem::Problem;

/// The maximum number of sweeps.
pub(crate) const SWEEPS_MAX: usize = (LINES_MAX * LINES_MAX * (THIRDS_MAX + 1)) as usize;

/// A recorder that flies a fleet toward targets, as its batteries allow, and stores its cells.
pub(crate) struct Recorder<'p, 'm> {
    problem: &'p Problem<'m>,
    charges_uj: Vec<u64>,
    /// Whether a low battery has sent each UAV home, where it charges as the policies do.
    charges: Vec<bool>,
    cells: Vec<Cell>,
    paths: Paths,
    level: u8,
    step: usize,
}

impl<'p, 'm> Recorder<'p, 'm> {
    pub(crate) fn new(problem: &'p Problem<'m>, level: u8) -> Self {
        let cells = problem.situation.cells.clone();
        let indices: Vec<u32> = cells.iter().map(|&cell| problem.odds.index(cell)).collect();
        Self {
            problem,
            charges_uj: problem.situation.charges_uj.clone(),
            charges: vec![false; cells.len()],
            cells,
            paths: Paths::hovering(&indices, problem.steps, level),
            level,
            step: 0,
        }
    }

    /// Returns the number of recorded steps.
    pub(crate) fn step(&self) -> usize {
        self.step
    }

    pub(crate) fn cell(&self, uav: usize) -> Cell {
        self.cells[uav]
    }

    /// Returns the charge of a UAV in µJ, at the highest consumption.
    pub(crate) fn charge_uj(&self, uav: usize) -> u64 {
        self.charges_uj[uav]
    }

    /// Returns whether the plan has reached its maximum number of steps.
    pub(crate) fn is_full(&self) -> bool {
        self.step == self.problem.steps
    }

    /// Records one step, in which each UAV flies toward its target, x before y.
    pub(crate) fn fly(&mut self, target: impl Fn(usize) -> Cell) {
        let level = self.level;
        self.fly_as(|uav| (target(uav), level));
    }

    /// Records one step, with a target and a level for each UAV.
    pub(crate) fn fly_as(&mut self, order: impl Fn(usize) -> (Cell, u8)) {
        let (model, odds) = (self.problem.model, &self.problem.odds);
        let config = model.config();
        self.step += 1;
        for uav in 0..self.cells.len() {
            let (from, charge_uj) = (self.cells[uav], self.charges_uj[uav]);
            let (target, level) = order(uav);
            let (to, level) = match duty(model, charge_uj, from) {
                Duty::Free if self.charges[uav] && self.stays(from, charge_uj) => (from, level),
                Duty::Free => {
                    self.charges[uav] = false;
                    let motion = toward(from, target);
                    let to = destination(from, motion, config.grid_width, config.grid_height);
                    (to, level)
                }
                Duty::Returns(there) => {
                    self.charges[uav] = true;
                    (there, level)
                }
                Duty::Grounded => (from, odds.grounded()),
            };
            let density = odds.densities().get(usize::from(level)).copied();
            self.charges_uj[uav] = after(model, charge_uj, from, to, density.unwrap_or(0.0));
            self.cells[uav] = to;
            self.paths.set(uav, self.step, odds.index(to), level);
        }
    }

    fn stays(&self, cell: Cell, charge_uj: u64) -> bool {
        let model = self.problem.model;
        (charge_uj as f64) < charge_to_leave_uj(model) && model.depots().contains(&cell)
    }

    pub(crate) fn finish(self) -> Paths {
        self.paths
    }
}

/// Returns the trajectories of every formation, sensing at a level.
pub(crate) fn sweeps(problem: &Problem<'_>, level: u8) -> Vec<Paths> {
    let config = problem.model.config();
    let cells = &problem.situation.cells;
    let start = cells.first().copied().unwrap_or_default();
    let formations = Formation::all(config, cells.len());
    let recorded = formations.map(|formation| {
        let mut ranks: Vec<Rank> = formation.ranks(config, start, cells.len()).collect();
        let mut recorder = Recorder::new(problem, level);
        let mut targets: Vec<Cell> = cells.clone();
        while !recorder.is_full() {
            for rank in &mut ranks {
                rank.advance(|uav| Some(recorder.cell(uav)));
                for (index, uav) in rank.uavs().enumerate() {
                    targets[uav] = rank.place(index);
                }
            }
            recorder.fly(|uav| targets[uav]);
        }
        recorder.finish()
    });
    recorded.collect()
}

/// Returns trajectories that leave others after a step: the planned UAVs then fly to the meeting
/// cell of the fleet, at the lowest pilot density.
pub(crate) fn gathered(problem: &Problem<'_>, paths: &Paths, from: usize) -> Paths {
    let mut recorder = Recorder::new(problem, 0);
    recorder.paths = paths.clone();
    while !recorder.is_full() {
        let step = recorder.step + 1;
        let planned = |uav| problem.odds.cell(paths.cell(uav, step));
        if step <= from {
            recorder.fly_as(|uav| (planned(uav), paths.level(uav, step)));
            continue;
        }
        let config = problem.model.config();
        let meeting = meeting_cell(
            recorder.cells.iter().copied(),
            config.grid_width,
            config.grid_height,
        );
        recorder.fly_as(|uav| {
            if problem.movers.contains(&uav) {
                (meeting, 0)
            } else {
                (planned(uav), paths.level(uav, step))
            }
        });
    }
    recorder.finish()
}

/// Returns the trajectories of a hovering fleet.
pub(crate) fn hovering(problem: &Problem<'_>) -> Paths {
    let mut recorder = Recorder::new(problem, problem.odds.highest());
    while !recorder.is_full() {
        let cells = problem.situation.cells.clone();
        recorder.fly(|uav| cells[uav]);
    }
    recorder.finish()
}
