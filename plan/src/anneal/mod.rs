//! Simulated annealing of the trajectories, one UAV at a time.
//!
//! All UAVs but one are fixed. The chance that fewer than θ UAVs detect a hotspot is then B - p D,
//! with p the chance that the one detects it. B is the chance that fewer than θ of the others do,
//! and D that exactly θ - 1 do. Both are worked out once for a batch of moves of that UAV. A move
//! costs a product for each site and each step from its first on, and no loop over the fleet.

use alloc::vec;
use alloc::vec::Vec;
use core::ops::ControlFlow;

use crate::battery;
use crate::draws::Draws;
use crate::odds::LANES;
use crate::paths::Paths;
use crate::problem::Problem;
use crate::watch::Watch;

mod detection;
mod meeting;
mod moves;
mod time;

use detection::found;
use moves::Move;

/// The number of moves of a UAV before the next UAV has its turn.
const BATCH: u64 = 256;
/// The probability of an unfinished episode below which the annealing evaluates no further step.
const NEGLIGIBLE: f64 = 1e-3;
/// Steps evaluated beyond that one.
const MARGIN: usize = 4;
/// The temperature at the start and at the end, in steps. Most plans begin with a good plan, which
/// more heat would undo.
const HOT: f64 = 0.03;
const COLD: f64 = 0.0025;
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
    /// F of each step.
    confirmed: Vec<f64>,
    /// Whether the fleet is one radio component in each step.
    meets: Vec<bool>,
    /// The probability that the episode has ended by each step.
    ended: Vec<f64>,
    /// Expected steps that have passed by the end of each step.
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
    exactly: Vec<[f64; LANES]>,
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
            confirmed: vec![0.0; steps + 1],
            meets: vec![false; steps + 1],
            ended: vec![0.0; steps + 1],
            spent: vec![0.0; steps + 1],
            part_of: vec![0; (steps + 1) * uavs],
            parts: vec![0; steps + 1],
            value: 0.0,
            battery_lasts: problem
                .situation
                .charges_uj
                .iter()
                .all(|&charge_uj| battery::never_low(problem.model, charge_uj, steps)),
            moved: Move::new(steps),
            row: vec![0.0; stride],
            factors: vec![0.0; stride],
            scratch: Vec::new(),
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
        self,
        iterations: u64,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> (Paths, bool) {
        let mut watch = Watch::new(progress);
        let paths = self.run_watched(iterations, &mut watch);
        (paths, watch.stopped() && watch.iterations() < iterations)
    }

    /// Anneals as [`Annealer::run`] does.
    pub(crate) fn run_watched(mut self, iterations: u64, watch: &mut Watch<'_>) -> Paths {
        let (steps, stride) = (self.problem.steps, self.problem.odds.stride());
        let products = steps * (stride + self.problem.products());
        let products_of_turn = steps * stride * self.paths.uav_count() + products;
        let mut best = (self.value, self.paths.clone());
        let movers = self.problem.movers.as_slice();
        let mut tried = 0;
        while tried < iterations && !movers.is_empty() {
            let share = tried as f64 / iterations as f64;
            let temperature = HOT * libm::pow(COLD / HOT, share);
            let uav = movers[self.draws.below(movers.len())];
            self.take_turn(uav);
            watch.work(products_of_turn);
            let batch = BATCH.min(iterations - tried);
            let mut done = 0;
            while done < batch && !watch.work(products) {
                self.try_move(temperature);
                done += 1;
            }
            tried += done;
            if self.value < best.0 - RESOLUTION {
                best = (self.value, self.paths.clone());
            }
            watch.found(best.0);
            watch.moved(done);
            if watch.stopped() {
                break;
            }
        }
        best.1
    }

    /// Tries one move of the UAV whose turn it is. Returns whether the move was made.
    pub fn try_move(&mut self, temperature: f64) -> bool {
        if !self.propose() {
            return false;
        }
        let most = self.value - temperature * libm::log(self.draws.unit());
        let better = self.judge(most);
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
        self.confirmed[0] = found(self.problem, &self.left[..stride]);
        let mut window = steps;
        for step in 1..=steps {
            self.fix_others(step);
            self.sense(step);
            self.find_parts(step);
            self.meet(step);
            self.account(step);
            if 1.0 - self.ended[step] < NEGLIGIBLE && window == steps {
                window = (step + MARGIN).min(steps);
            }
            if step >= window {
                break;
            }
        }
        self.window = window;
        self.value = self.spent[window] + self.rest(self.ended[window]);
    }

    /// Applies the proposal to the present trajectories.
    fn make(&mut self) {
        let (first, last) = (self.moved.first, self.moved.last);
        for step in first..=last {
            let (cell, level) = (self.moved.cells[step], self.moved.levels[step]);
            self.paths.set(self.uav, step, cell, level);
            self.meets[step] = self.moved.meets[step];
        }
        for step in first..=self.window {
            if step <= last {
                self.sense(step);
            } else {
                self.accumulate(step);
            }
            self.account(step);
        }
        self.value = self.spent[self.window] + self.rest(self.ended[self.window]);
    }
}
