//! Simulated annealing of the trajectories, one UAV at a time.
//!
//! All UAVs but one are held. The chance that fewer than θ UAVs detect a hotspot is then B - p D,
//! with p the chance that the one detects it. B is the chance that fewer than θ of the others do,
//! and D that exactly θ - 1 do. Both are worked out once for a batch of moves of that UAV. A move
//! costs a product for each site and each step from its first on, and no loop over the fleet.

use alloc::vec;
use alloc::vec::Vec;
use core::ops::ControlFlow;

use jcas_core::Cell;

use crate::battery;
use crate::draws::Draws;
use crate::gather::steps_to_meet;
use crate::odds::LANES;
use crate::paths::Paths;
use crate::problem::{Problem, power};

/// The number of moves of a UAV before the next UAV has its turn.
const BATCH: u64 = 256;
/// The probability of an unfinished episode below which the annealing evaluates no further step.
const NEGLIGIBLE: f64 = 1e-3;
/// Steps that an episode is assumed to last from there.
const REST: f64 = 12.0;
/// Steps evaluated beyond that one.
const MARGIN: usize = 4;
/// The temperature at the start and at the end, in steps.
const HOT: f64 = 0.25;
const COLD: f64 = 0.0025;
/// The chance of the last confirmation in a step below which the step adds nothing to the
/// gathering.
const RARE: f64 = 1e-5;
/// The marker of a G that has not been computed.
const UNKNOWN: u32 = u32::MAX - 1;
/// The least gain in expected steps that counts as a gain.
const RESOLUTION: f64 = 1e-9;

/// Settings of an annealing: its length and its seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Number of moves to try.
    pub iterations: u64,
    /// Seed of the moves.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            iterations: 2_000_000,
            seed: 1,
        }
    }
}

/// The progress of an annealing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Number of moves tried.
    pub iterations: u64,
    /// Expected steps of the best plan so far.
    pub best_steps: f64,
}

/// The state of an annealing of the trajectories of one problem.
pub struct Annealer<'p, 'm> {
    problem: &'p Problem<'m>,
    paths: Paths,
    draws: Draws,
    /// The UAV whose turn it is.
    uav: usize,
    /// Number of steps that are evaluated.
    window: usize,
    /// B and D of each step and site.
    below: Vec<f64>,
    edge: Vec<f64>,
    /// The chance that a hotspot is missed in each step, and in all steps so far.
    missed: Vec<f64>,
    left: Vec<f64>,
    /// F and G of each step. G is computed only where it matters.
    done: Vec<f64>,
    gather: Vec<u32>,
    /// Expected steps that have passed by the end of each step, with the gathering of episodes that
    /// are confirmed by then.
    spent: Vec<f64>,
    /// For each step and UAV the radio component without the UAV whose turn it is.
    part_of: Vec<u8>,
    parts: Vec<u128>,
    value: f64,
    battery_lasts: bool,
    moved: Move,
    row: Vec<f64>,
    factors: Vec<f64>,
    scratch: Vec<f64>,
    cells: Vec<Cell>,
    exactly: Vec<[f64; LANES]>,
}

/// A proposal: new cells and levels for the steps from `first` to `last`.
#[derive(Default)]
struct Move {
    first: usize,
    last: usize,
    cells: Vec<u32>,
    levels: Vec<u8>,
    gather: Vec<u32>,
    /// The chance that the last confirmation is in each step.
    chance: Vec<f64>,
}

impl<'p, 'm> Annealer<'p, 'm> {
    /// Makes an annealing that begins with these trajectories.
    #[must_use]
    pub fn new(problem: &'p Problem<'m>, paths: Paths, seed: u64) -> Self {
        let (steps, stride) = (problem.steps, problem.odds.stride());
        let uavs = paths.uav_count();
        let table = || vec![1.0; (steps + 1) * stride];
        let mut annealer = Self {
            problem,
            draws: Draws::new(seed),
            uav: 0,
            window: steps,
            below: table(),
            edge: table(),
            missed: table(),
            left: table(),
            done: vec![0.0; steps + 1],
            gather: vec![UNKNOWN; steps + 1],
            spent: vec![0.0; steps + 1],
            part_of: vec![0; (steps + 1) * uavs],
            parts: vec![0; steps + 1],
            value: 0.0,
            battery_lasts: problem
                .situation
                .charges_uj
                .iter()
                .all(|&charge_uj| battery::never_low(problem.model, charge_uj, steps)),
            moved: Move {
                cells: vec![0; steps + 1],
                levels: vec![0; steps + 1],
                gather: vec![UNKNOWN; steps + 1],
                chance: vec![0.0; steps + 1],
                ..Move::default()
            },
            row: vec![0.0; stride],
            factors: vec![0.0; stride],
            scratch: Vec::new(),
            cells: Vec::new(),
            exactly: vec![[0.0; LANES]; problem.model.config().quorum as usize],
            paths,
        };
        annealer.take_turn(0);
        annealer
    }

    /// Returns the expected steps of the present trajectories, without the remainder after the
    /// evaluated steps.
    #[must_use]
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Returns the present trajectories.
    #[must_use]
    pub fn paths(&self) -> &Paths {
        &self.paths
    }

    /// Anneals and returns the best trajectories. `progress` is called after each batch of moves
    /// and may end the annealing. The flag says whether it did.
    pub fn run(
        mut self,
        iterations: u64,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> (Paths, bool) {
        let mut best = (self.value, self.paths.clone());
        let movers = self.problem.movers.as_slice();
        let mut tried = 0;
        while tried < iterations && !movers.is_empty() {
            let share = tried as f64 / iterations as f64;
            let temperature = HOT * libm::pow(COLD / HOT, share);
            let uav = movers[self.draws.below(movers.len())];
            self.take_turn(uav);
            let batch = BATCH.min(iterations - tried);
            for _ in 0..batch {
                self.try_move(temperature);
            }
            tried += batch;
            if self.value < best.0 - RESOLUTION {
                best = (self.value, self.paths.clone());
            }
            let report = Progress {
                iterations: tried,
                best_steps: best.0,
            };
            if progress(report).is_break() {
                return (best.1, tried < iterations);
            }
        }
        (best.1, false)
    }

    /// Tries one move of the UAV whose turn it is. Returns whether the move was made.
    pub fn try_move(&mut self, temperature: f64) -> bool {
        if !self.propose() {
            return false;
        }
        let most = self.value - temperature * libm::log(self.draws.unit());
        let better = self.judge(most).is_some();
        if better {
            self.make();
        }
        better
    }

    /// Gives a UAV its turn: computes B and D, and all other tables anew.
    pub fn take_turn(&mut self, uav: usize) {
        self.uav = uav;
        let (steps, stride) = (self.problem.steps, self.problem.odds.stride());
        for draw in &self.problem.draws {
            self.left[draw.sites.clone()].copy_from_slice(&draw.weights);
        }
        self.done[0] = found(self.problem, &self.left[..stride]);
        let mut window = steps;
        for step in 1..=steps {
            self.hold_others(step);
            self.look(step);
            self.find_parts(step);
            if 1.0 - self.done[step] < NEGLIGIBLE && window == steps {
                window = (step + MARGIN).min(steps);
            }
            if step >= window {
                break;
            }
        }
        self.window = window;
        self.account(1);
    }

    /// Computes the expected steps so far from a step on, and the value.
    fn account(&mut self, first: usize) {
        for step in first..=self.window {
            let cost = self.cost(step, self.done[step - 1], self.done[step]);
            self.spent[step] = self.spent[step - 1] + cost;
        }
        self.value = self.spent[self.window] + self.rest(self.done[self.window]);
    }

    /// Computes B and D of a step.
    fn hold_others(&mut self, step: usize) {
        let (odds, stride) = (&self.problem.odds, self.problem.odds.stride());
        let quorum = self.exactly.len();
        let span = step * stride..(step + 1) * stride;
        let below = lanes_mut(&mut self.below[span.clone()]);
        let edge = lanes_mut(&mut self.edge[span]);
        for (chunk, (below, edge)) in below.iter_mut().zip(edge).enumerate() {
            self.exactly.fill([0.0; LANES]);
            self.exactly[0] = [1.0; LANES];
            for uav in 0..self.paths.uav_count() {
                if uav == self.uav {
                    continue;
                }
                let (level, cell) = (self.paths.level(uav, step), self.paths.cell(uav, step));
                let odds = &lanes(odds.row(level, cell, &mut self.scratch))[chunk];
                for k in (1..quorum).rev() {
                    let (fewer, exactly) = self.exactly.split_at_mut(k);
                    for lane in 0..LANES {
                        exactly[0][lane] =
                            exactly[0][lane] * (1.0 - odds[lane]) + fewer[k - 1][lane] * odds[lane];
                    }
                }
                for lane in 0..LANES {
                    self.exactly[0][lane] *= 1.0 - odds[lane];
                }
            }
            *below = [0.0; LANES];
            for exactly in &self.exactly {
                for lane in 0..LANES {
                    below[lane] += exactly[lane];
                }
            }
            *edge = self.exactly[quorum - 1];
        }
    }

    /// Computes the chances of a miss in a step and so far, and F, from B and D.
    fn look(&mut self, step: usize) {
        let stride = self.problem.odds.stride();
        let (level, cell) = (
            self.paths.level(self.uav, step),
            self.paths.cell(self.uav, step),
        );
        let odds = self.problem.odds.row(level, cell, &mut self.scratch);
        let at = step * stride;
        let (below, edge) = (&self.below[at..at + stride], &self.edge[at..at + stride]);
        factors(below, edge, odds, &mut self.missed[at..at + stride]);
        self.accumulate(step);
    }

    /// Computes the chances of a miss in all steps so far, and F, from those in a step.
    fn accumulate(&mut self, step: usize) {
        let stride = self.problem.odds.stride();
        let at = step * stride;
        let (before, now) = self.left[at - stride..at + stride].split_at_mut(stride);
        now.copy_from_slice(before);
        self.done[step] = miss(self.problem, now, &self.missed[at..at + stride]);
    }

    /// Computes the radio components of the other UAVs in a step.
    fn find_parts(&mut self, step: usize) {
        let (odds, uavs) = (&self.problem.odds, self.paths.uav_count());
        let part_of = &mut self.part_of[step * uavs..][..uavs];
        let place = |uav: usize| {
            (
                odds.cell(self.paths.cell(uav, step)),
                self.paths.level(uav, step),
            )
        };
        part_of.fill(u8::MAX);
        let mut parts = 0;
        let mut open = [0u8; crate::gather::UAVS_MAX];
        for seed in 0..uavs {
            if seed == self.uav || part_of[seed] != u8::MAX {
                continue;
            }
            part_of[seed] = parts;
            open[0] = seed as u8;
            let mut count = 1;
            while count > 0 {
                count -= 1;
                let here = place(usize::from(open[count]));
                for uav in 0..uavs {
                    if uav != self.uav && part_of[uav] == u8::MAX && odds.linked(here, place(uav)) {
                        part_of[uav] = parts;
                        open[count] = uav as u8;
                        count += 1;
                    }
                }
            }
            parts += 1;
        }
        self.parts[step] = if parts == 0 {
            0
        } else {
            u128::MAX >> (128 - parts)
        };
    }

    /// Returns G of a step, with the UAV whose turn it is in a cell and at a level.
    fn gathering(&mut self, step: usize, cell: u32, level: u8) -> u32 {
        let (problem, uavs) = (self.problem, self.paths.uav_count());
        let odds = &problem.odds;
        let here = (odds.cell(cell), level);
        let mut met = 0u128;
        for uav in 0..uavs {
            if uav != self.uav {
                let there = (
                    odds.cell(self.paths.cell(uav, step)),
                    self.paths.level(uav, step),
                );
                let bit = 1 << self.part_of[step * uavs + uav];
                met |= if odds.linked(here, there) { bit } else { 0 };
            }
        }
        if met == self.parts[step] {
            return 0;
        }
        self.cells.clear();
        for uav in 0..uavs {
            self.cells.push(if uav == self.uav {
                here.0
            } else {
                odds.cell(self.paths.cell(uav, step))
            });
        }
        steps_to_meet(problem.model, odds, &mut self.cells)
    }

    /// Returns what a step adds to the expected time. That is the step itself, and the gathering of
    /// the episodes with their last confirmation in it.
    fn cost(&mut self, step: usize, before: f64, after: f64) -> f64 {
        let chance = after - before;
        let mut cost = 1.0 - before;
        if chance > RARE {
            if self.gather[step] == UNKNOWN {
                let (cell, level) = (
                    self.paths.cell(self.uav, step),
                    self.paths.level(self.uav, step),
                );
                self.gather[step] = self.gathering(step, cell, level);
            }
            cost += chance * self.wait(step, self.gather[step]);
        }
        cost
    }

    /// Steps of gathering that count.
    fn wait(&self, step: usize, gather: u32) -> f64 {
        f64::from(gather.min(self.problem.steps_left - step as u32))
    }

    /// Returns the remainder after the evaluated steps, as if nothing more were confirmed.
    fn rest(&self, done: f64) -> f64 {
        (1.0 - done) * REST.min(f64::from(self.problem.steps_left) - self.window as f64)
    }

    /// Returns the expected steps with the proposal; `None` if they are more than `most`.
    fn judge(&mut self, most: f64) -> Option<f64> {
        let (problem, stride) = (self.problem, self.problem.odds.stride());
        let (first, last) = (self.moved.first, self.moved.last);
        let mut value = self.spent[first - 1];
        let mut row = core::mem::take(&mut self.row);
        row.copy_from_slice(&self.left[(first - 1) * stride..first * stride]);
        let mut before = self.done[first - 1];
        for step in first..=self.window {
            let at = step * stride;
            let done = if step <= last {
                let (level, cell) = (self.moved.levels[step], self.moved.cells[step]);
                let odds = problem.odds.row(level, cell, &mut self.scratch);
                let (below, edge) = (&self.below[at..at + stride], &self.edge[at..at + stride]);
                factors(below, edge, odds, &mut self.factors);
                miss(problem, &mut row, &self.factors)
            } else {
                miss(problem, &mut row, &self.missed[at..at + stride])
            };
            if step <= last {
                // Gathering is the most expensive part. It is computed last, once all else is good
                // enough.
                self.moved.chance[step] = done - before;
                value += 1.0 - before;
            } else {
                value += self.cost(step, before, done);
            }
            before = done;
            if value > most {
                break;
            }
        }
        self.row = row;
        value += self.rest(before);
        for step in first..=last.min(self.window) {
            if value > most {
                return None;
            }
            let chance = self.moved.chance[step];
            self.moved.gather[step] = UNKNOWN;
            if chance > RARE {
                let (level, cell) = (self.moved.levels[step], self.moved.cells[step]);
                let gather = self.gathering(step, cell, level);
                self.moved.gather[step] = gather;
                value += chance * self.wait(step, gather);
            }
        }
        (value <= most).then_some(value)
    }

    /// Applies the proposal to the present trajectories.
    fn make(&mut self) {
        let (first, last) = (self.moved.first, self.moved.last);
        for step in first..=last {
            let (cell, level) = (self.moved.cells[step], self.moved.levels[step]);
            self.paths.set(self.uav, step, cell, level);
            self.gather[step] = if step <= self.window {
                self.moved.gather[step]
            } else {
                UNKNOWN
            };
        }
        for step in first..=self.window {
            if step <= last {
                self.look(step);
            } else {
                self.accumulate(step);
            }
        }
        self.account(first);
    }

    /// Draws and writes a proposal. Returns `false` if it is empty or not legal.
    fn propose(&mut self) -> bool {
        let window = self.window;
        if window == 0 {
            return false;
        }
        let step = 1 + self.draws.below(window);
        let proposed = match self.draws.below(16) {
            0..=4 => self.swap_motions(step),
            5..=8 => self.shift(step),
            9..=11 => self.shift_in_time(step),
            12..=13 => self.detour(step),
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

    /// Detours by way of a random cell, then flies straight to the first cell of the old path in
    /// reach.
    fn detour(&mut self, first: usize) -> bool {
        let config = *self.problem.model.config();
        let reach = 2 + self.draws.below(6) as i64;
        let here = self.at(first);
        let side = 2 * reach as usize + 1;
        let via = Cell {
            x: within(
                i64::from(here.x) - reach + self.draws.below(side) as i64,
                config.grid_width,
            ),
            y: within(
                i64::from(here.y) - reach + self.draws.below(side) as i64,
                config.grid_height,
            ),
        };
        let steps = self.problem.steps;
        let wait = self.draws.below(3);
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

/// Computes F from the weighted chance that each site has been missed so far.
fn found(problem: &Problem<'_>, left: &[f64]) -> f64 {
    let mut product = 1.0;
    for draw in &problem.draws {
        let mut sums = [0.0; LANES];
        for left in lanes(&left[draw.sites.clone()]) {
            for lane in 0..LANES {
                sums[lane] += left[lane];
            }
        }
        product *= power(complement(&sums), draw.count);
    }
    product
}

/// Multiplies the chance of a miss of each site by one more factor, and returns F after that.
fn miss(problem: &Problem<'_>, left: &mut [f64], factors: &[f64]) -> f64 {
    let mut product = 1.0;
    for draw in &problem.draws {
        let mut sums = [0.0; LANES];
        let left = lanes_mut(&mut left[draw.sites.clone()]);
        for (left, factors) in left.iter_mut().zip(lanes(&factors[draw.sites.clone()])) {
            for lane in 0..LANES {
                left[lane] *= factors[lane];
                sums[lane] += left[lane];
            }
        }
        product *= power(complement(&sums), draw.count);
    }
    product
}

/// Computes B - p D for each site.
fn factors(below: &[f64], edge: &[f64], odds: &[f64], factors: &mut [f64]) {
    let others = lanes(below).iter().zip(lanes(edge));
    let chunks = lanes_mut(factors).iter_mut().zip(lanes(odds));
    for ((factors, odds), (below, edge)) in chunks.zip(others) {
        for lane in 0..LANES {
            factors[lane] = below[lane] - odds[lane] * edge[lane];
        }
    }
}

fn lanes(row: &[f64]) -> &[[f64; LANES]] {
    row.as_chunks().0
}

fn lanes_mut(row: &mut [f64]) -> &mut [[f64; LANES]] {
    row.as_chunks_mut().0
}

/// Returns what the lanes leave of 1.
fn complement(sums: &[f64; LANES]) -> f64 {
    let [a, b, c, d, e, f, g, h] = sums;
    let found = 1.0 - (((a + e) + (b + f)) + ((c + g) + (d + h)));
    if found > 0.0 { found } else { 0.0 }
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
