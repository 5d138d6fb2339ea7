//! The moves of the annealing: proposals of other cells or pilot densities for some steps.

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::Cell;

use super::Annealer;
use crate::battery;

/// A proposal: new cells and levels for the steps from `first` to `last`.
pub(super) struct Move {
    pub(super) first: usize,
    pub(super) last: usize,
    pub(super) cells: Vec<u32>,
    pub(super) levels: Vec<u8>,
    pub(super) meets: Vec<bool>,
}

impl Move {
    pub(super) fn new(steps: usize) -> Self {
        Self {
            first: 0,
            last: 0,
            cells: vec![0; steps + 1],
            levels: vec![0; steps + 1],
            meets: vec![false; steps + 1],
        }
    }
}

impl Annealer<'_, '_> {
    /// Draws and writes a proposal. Returns `false` if it is empty or not legal.
    pub(super) fn propose(&mut self) -> bool {
        let window = self.window;
        if window == 0 {
            return false;
        }
        let step = 1 + self.draws.below(window);
        let proposed = match self.draws.below(16) {
            0..=3 => self.swap_motions(step),
            4..=6 => self.shift(step),
            7..=9 => self.shift_in_time(step),
            10..=11 => self.detour(step),
            12..=13 => self.follow(step),
            _ => self.change_level(step),
        };
        proposed && self.is_legal()
    }

    /// Returns whether the battery lasts for the proposal.
    fn is_legal(&self) -> bool {
        if self.battery_lasts {
            return true;
        }
        let uav = self.uav;
        let (first, last) = (self.moved.first, self.moved.last);
        let mut cells = self.paths.cells_of(uav).to_vec();
        let mut levels = self.paths.levels_of(uav).to_vec();
        cells[first..=last].copy_from_slice(&self.moved.cells[first..=last]);
        levels[first..=last].copy_from_slice(&self.moved.levels[first..=last]);
        let charge_uj = self.problem.situation.charges_uj[uav];
        battery::allows(
            self.problem.model,
            &self.problem.odds,
            charge_uj,
            &cells,
            &levels,
        )
    }

    /// Copies the steps of the proposal from the present trajectory.
    fn copy(&mut self, first: usize, last: usize) {
        self.moved.first = first;
        self.moved.last = last;
        self.moved.cells[first..=last]
            .copy_from_slice(&self.paths.cells_of(self.uav)[first..=last]);
        self.moved.levels[first..=last]
            .copy_from_slice(&self.paths.levels_of(self.uav)[first..=last]);
    }

    fn at(&self, step: usize) -> Cell {
        self.problem.odds.cell(self.paths.cell(self.uav, step))
    }

    /// Draws a later step of the plan, more often a near one than a far one.
    fn later(&mut self, step: usize) -> usize {
        let reach = 1 << self.draws.below(6);
        (step + self.draws.below(reach + 1)).min(self.problem.steps)
    }

    /// Shifts the cells between two steps by the difference of the motions in these steps, which
    /// are swapped.
    fn swap_motions(&mut self, first: usize) -> bool {
        let last = self.later(first);
        if last == first {
            return false;
        }
        let (a, b) = (self.at(first - 1), self.at(first));
        let (c, d) = (self.at(last - 1), self.at(last));
        let dx = difference(d.x, c.x) - difference(b.x, a.x);
        let dy = difference(d.y, c.y) - difference(b.y, a.y);
        (dx, dy) != (0, 0) && self.displace(first, last - 1, dx, dy)
    }

    /// Shifts the cells between two steps by one cell.
    fn shift(&mut self, first: usize) -> bool {
        let last = if self.draws.below(8) == 0 {
            self.problem.steps
        } else {
            self.later(first)
        };
        let (dx, dy) = [(1, 0), (-1, 0), (0, 1), (0, -1)][self.draws.below(4)];
        self.displace(first, last, dx, dy)
    }

    /// Moves the cells from one step to another; cells off the grid end at its border.
    fn displace(&mut self, first: usize, last: usize, dx: i64, dy: i64) -> bool {
        self.copy(first, last);
        let config = self.problem.model.config();
        let mut changed = false;
        for step in first..=last {
            let cell = self.problem.odds.cell(self.moved.cells[step]);
            let moved = Cell {
                x: within(i64::from(cell.x) + dx, config.grid_width),
                y: within(i64::from(cell.y) + dy, config.grid_height),
            };
            changed |= moved != cell;
            self.moved.cells[step] = self.problem.odds.index(moved);
        }
        changed && self.joins()
    }

    /// Returns whether both ends of the proposal are within one cell of the rest of the trajectory.
    fn joins(&self) -> bool {
        let odds = &self.problem.odds;
        let (first, last) = (self.moved.first, self.moved.last);
        let begins = odds.cell(self.moved.cells[first]);
        let ends = odds.cell(self.moved.cells[last]);
        begins.manhattan(self.at(first - 1)) <= 1
            && (last == self.problem.steps || ends.manhattan(self.at(last + 1)) <= 1)
    }

    /// Shifts the cells between two steps in time by one step. The other end waits or is cut.
    fn shift_in_time(&mut self, first: usize) -> bool {
        let last = if self.draws.below(2) == 0 {
            self.problem.steps
        } else {
            self.later(first)
        };
        if last == first {
            return false;
        }
        self.copy(first, last);
        let sooner = self.draws.below(2) == 0;
        let odds = &self.problem.odds;
        if sooner {
            self.moved.cells.copy_within(first + 1..last + 1, first);
            if odds
                .cell(self.moved.cells[first])
                .manhattan(self.at(first - 1))
                > 1
            {
                return false;
            }
        } else {
            self.moved.cells.copy_within(first..last, first + 1);
            self.moved.cells[first] = self.paths.cell(self.uav, first - 1);
        }
        self.joins()
    }

    /// Draws a cell within a few cells of another.
    fn around(&mut self, here: Cell, reach: usize) -> Cell {
        let config = self.problem.model.config();
        let side = 2 * reach + 1;
        let mut draw = |at: u32| i64::from(at) - reach as i64 + self.draws.below(side) as i64;
        let (x, y) = (draw(here.x), draw(here.y));
        Cell {
            x: within(x, config.grid_width),
            y: within(y, config.grid_height),
        }
    }

    /// Detours by way of a random cell, then flies straight to the first cell of the old path in
    /// reach. The random cell is near a known hotspot or near the old path.
    fn detour(&mut self, first: usize) -> bool {
        let known = self.problem.known.len();
        let (via, wait) = if known > 0 && self.draws.below(2) == 0 {
            let hotspot = self.problem.known[self.draws.below(known)];
            let reach = self.draws.below(3);
            (self.around(hotspot, reach), self.draws.below(8))
        } else {
            let reach = 2 + self.draws.below(6);
            (self.around(self.at(first), reach), self.draws.below(3))
        };
        let steps = self.problem.steps;
        let start = self.at(first - 1);
        let arrival = first - 1 + start.manhattan(via) as usize + wait;
        // This is the first step from which the old path is in reach.
        let mut last = arrival;
        while last < steps && via.manhattan(self.at(last)) as usize > last - arrival {
            last += 1;
        }
        if last > steps || last < first {
            return false;
        }
        self.copy(first, last);
        let turn = self.draws.below(2) == 0;
        let mut cell = start;
        for step in first..=last {
            let target = if step <= arrival { via } else { self.at(last) };
            cell = nearer(cell, target, turn);
            self.moved.cells[step] = self.problem.odds.index(cell);
        }
        self.joins()
    }

    /// Flies straight to where another UAV will be and follows it, to the end or for some steps. It
    /// then flies back to its old path.
    fn follow(&mut self, first: usize) -> bool {
        let uavs = self.paths.uav_count();
        if uavs < 2 {
            return false;
        }
        let leader = (self.uav + 1 + self.draws.below(uavs - 1)) % uavs;
        let (steps, start) = (self.problem.steps, self.at(first - 1));
        let there = |step: usize| self.problem.odds.cell(self.paths.cell(leader, step));
        let in_reach = |step: &usize| start.manhattan(there(*step)) as usize <= step - first + 1;
        let Some(meeting) = (first..=steps).find(in_reach) else {
            return false;
        };
        let target = there(meeting);
        let turn = self.draws.below(2) == 0;
        let leave = if self.draws.below(2) == 0 {
            steps
        } else {
            self.later(meeting)
        };
        let left = self.problem.odds.cell(self.paths.cell(leader, leave));
        let back = |step: &usize| left.manhattan(self.at(*step)) as usize <= step - leave;
        let last = (leave..steps).find(back).unwrap_or(steps);
        self.copy(first, last);
        let mut cell = start;
        for step in first..=last {
            cell = if step < meeting {
                nearer(cell, target, turn)
            } else if step <= leave {
                self.problem.odds.cell(self.paths.cell(leader, step))
            } else {
                nearer(cell, self.at(last), turn)
            };
            self.moved.cells[step] = self.problem.odds.index(cell);
            if step >= meeting && step <= leave {
                self.moved.levels[step] = self.paths.level(leader, step);
            }
        }
        self.joins()
    }

    /// Changes the pilot density for some steps.
    fn change_level(&mut self, first: usize) -> bool {
        let levels = self.problem.odds.densities().len();
        if levels == 1 {
            return false;
        }
        let last = if self.draws.below(4) == 0 {
            self.problem.steps
        } else {
            self.later(first)
        };
        self.copy(first, last);
        let level = self.draws.below(levels) as u8;
        let grounded = self.problem.odds.grounded();
        let mut changed = false;
        for now in &mut self.moved.levels[first..=last] {
            if *now != grounded {
                changed |= *now != level;
                *now = level;
            }
        }
        changed
    }
}

fn difference(a: u32, b: u32) -> i64 {
    i64::from(a) - i64::from(b)
}

fn within(value: i64, extent: u32) -> u32 {
    value.max(0).min(i64::from(extent) - 1) as u32
}

/// Returns the cell one step nearer to a target, along x first or along y first.
fn nearer(from: Cell, to: Cell, x_first: bool) -> Cell {
    let step = |from: u32, to: u32| {
        if from < to {
            from + 1
        } else {
            from.saturating_sub(u32::from(from > to))
        }
    };
    if (x_first || from.y == to.y) && from.x != to.x {
        Cell {
            x: step(from.x, to.x),
            y: from.y,
        }
    } else {
        Cell {
            x: from.x,
            y: step(from.y, to.y),
        }
    }
}
