//! Initial trajectories for hidden hotspots: lines of UAVs abreast that sweep the grid.

use alloc::vec::Vec;

use jcas_core::Cell;
use jcas_core::motion::{destination, toward};

use crate::battery::{Duty, after, duty};
use crate::gather::meeting_cell;
use crate::paths::Paths;
use crate::problem::Problem;

/// The maximum number of lines, and of strips that a line sweeps one after the other.
const MOST: u32 = 4;
/// The maximum spread of a line, in thirds of the width of its strip; 0 is a flock.
const THIRDS: u32 = 3;

/// The maximum number of sweeps.
pub(crate) const SWEEPS_MAX: usize = (MOST * MOST * (THIRDS + 1)) as usize;

/// A recorder that flies a fleet toward targets, as its batteries allow, and stores its cells.
pub(crate) struct Recorder<'p, 'm> {
    problem: &'p Problem<'m>,
    charges_uj: Vec<u64>,
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
                Duty::Free => {
                    let motion = toward(from, target);
                    let to = destination(from, motion, config.grid_width, config.grid_height);
                    (to, level)
                }
                Duty::Returns(there) => (there, level),
                Duty::Grounded => (from, odds.grounded()),
            };
            let density = odds.densities().get(usize::from(level)).copied();
            self.charges_uj[uav] = after(model, charge_uj, from, to, density.unwrap_or(0.0));
            self.cells[uav] = to;
            self.paths.set(uav, self.step, odds.index(to), level);
        }
    }

    pub(crate) fn finish(self) -> Paths {
        self.paths
    }
}

/// A line with its stations, and the offset of each of its UAVs across.
struct Rank {
    first: usize,
    places: Vec<i64>,
    /// The stations as (across, along), in cells.
    stations: Vec<(i64, i64)>,
    next: usize,
    forward: bool,
}

/// Returns the width across the sweep, the length along it, and whether x runs along it.
fn extents(problem: &Problem<'_>) -> (i64, i64, bool) {
    let config = problem.model.config();
    let (width, height) = (config.grid_width, config.grid_height);
    (
        i64::from(width.min(height)),
        i64::from(width.max(height)),
        width > height,
    )
}

impl Rank {
    fn place(&self, problem: &Problem<'_>, index: usize) -> Cell {
        let (across, _, transposed) = extents(problem);
        let (x, y) = self.stations[self.next];
        let x = (x + self.places[index]).max(0).min(across - 1) as u32;
        let y = y as u32;
        if transposed {
            Cell { x: y, y: x }
        } else {
            Cell { x, y }
        }
    }

    /// Advances to the next station once most UAVs of the line are in place, and turns back at the
    /// end.
    fn advance(&mut self, recorder: &Recorder<'_, '_>) {
        let last = self.stations.len() - 1;
        let count = self.places.len();
        let arrived = (0..count)
            .filter(|&index| {
                recorder.cell(self.first + index) == self.place(recorder.problem, index)
            })
            .count();
        if count == 0 || 2 * arrived <= count || last == 0 {
            return;
        }
        if self.next == if self.forward { last } else { 0 } {
            self.forward = !self.forward;
        }
        self.next = if self.forward {
            self.next + 1
        } else {
            self.next - 1
        };
    }
}

fn rows(problem: &Problem<'_>, lines: i64, strips: i64, thirds: i64) -> Vec<Rank> {
    let (across, along, transposed) = extents(problem);
    let uavs = problem.situation.cells.len();
    let start = problem.situation.cells.first().copied().unwrap_or_default();
    let start = i64::from(if transposed { start.x } else { start.y });
    (0..lines)
        .map(|line| {
            let share = |end: i64| end as usize * uavs / lines as usize;
            let (low, high) = (line * along / lines, (line + 1) * along / lines);
            let near_first = (start - low).abs() <= (start - (high - 1)).abs();
            let length = high - low;
            let stations = (0..strips * length)
                .map(|station| {
                    let (strip, step) = (station / length, station % length);
                    let x = (across * (2 * strip + 1) / (2 * strips)).min(across - 1);
                    if (strip % 2 == 0) == near_first {
                        (x, low + step)
                    } else {
                        (x, high - 1 - step)
                    }
                })
                .collect();
            let count = (share(line + 1) - share(line)) as i64;
            let places = (0..count)
                .map(|k| {
                    let twice = (2 * k - (count - 1)) * across * thirds;
                    twice.div_euclid(2 * i64::from(THIRDS) * strips * count)
                })
                .collect();
            Rank {
                first: share(line),
                places,
                stations,
                next: 0,
                forward: true,
            }
        })
        .collect()
}

/// Returns the trajectories of every formation, sensing at a level.
pub(crate) fn sweeps(problem: &Problem<'_>, level: u8) -> Vec<Paths> {
    let (across, along, _) = extents(problem);
    let uavs = problem.situation.cells.len() as i64;
    let lines_max = i64::from(MOST).min(uavs).min(along);
    let strips_max = i64::from(MOST).min(across);
    let mut sweeps = Vec::new();
    for lines in 1..=lines_max {
        for strips in 1..=strips_max {
            for thirds in 0..=i64::from(THIRDS) {
                let mut rows = rows(problem, lines, strips, thirds);
                let mut recorder = Recorder::new(problem, level);
                let mut targets: Vec<Cell> = problem.situation.cells.clone();
                while !recorder.is_full() {
                    for row in &mut rows {
                        row.advance(&recorder);
                        for index in 0..row.places.len() {
                            targets[row.first + index] = row.place(problem, index);
                        }
                    }
                    recorder.fly(|uav| targets[uav]);
                }
                sweeps.push(recorder.finish());
            }
        }
    }
    sweeps
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
