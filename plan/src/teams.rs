//! Initial trajectories for known hotspots: teams that fly from hotspot to hotspot.

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::Cell;
use jcas_core::motion::{destination, toward};

use crate::formation::Recorder;
use crate::objective::hazard;
use crate::paths::Paths;
use crate::problem::Problem;
use crate::routes::{Routes, changes, nearest_first};
use crate::watch::Watch;

/// The hazards after which a team leaves a hotspot. A hazard of h leaves it unconfirmed with
/// probability exp(-h).
const ENOUGH: [f64; 4] = [0.3, 0.8, 1.5, 3.0];
/// The hazard at which routes are compared.
const COMPARED: f64 = 1.5;
/// The weight of the mean time of a confirmation, beside the time of the last one.
const MEAN_WEIGHT: f64 = 0.1;
/// The maximum number of teams.
pub(crate) const TEAMS_MAX: usize = 8;
/// The maximum number of routes that are compared for a number of teams.
const COMPARISONS_MAX: usize = 300;
/// The numbers of teams whose tours are kept.
const COUNTS_MAX: usize = 3;

/// The maximum number of tours at one level.
pub(crate) const TOURS_MAX: usize = COUNTS_MAX * ENOUGH.len();

/// Returns tours of one to several teams, with several hover times, sensing at each of some levels.
/// It is empty if no hotspot is known.
pub(crate) fn tours(problem: &Problem<'_>, levels: &[u8], watch: &mut Watch<'_>) -> Vec<Paths> {
    let known = problem.known.len();
    if known == 0 {
        return Vec::new();
    }
    let quorum = problem.model.config().quorum as usize;
    let uavs = problem.situation.cells.len();
    let most = (uavs / quorum).max(1).min(known).min(TEAMS_MAX);
    let mut fleets: Vec<(f64, Teams<'_, '_>, Routes)> = (1..=most)
        .map(|count| {
            let teams = Teams::new(problem, count);
            let routes = teams.shortened(teams.nearest_first(), watch);
            (teams.time(&routes), teams, routes)
        })
        .collect();
    fleets.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut tours = Vec::new();
    for (_, teams, routes) in fleets.iter().take(COUNTS_MAX) {
        for &level in levels {
            for enough in ENOUGH {
                tours.push(teams.recorded(routes, enough, level));
            }
        }
    }
    tours
}

/// A fleet in teams of nearly equal size.
///
/// Let q be the chance that a quorum of a team detects a hotspot from a cell in one step. It adds
/// -ln(1 - q) to the hazard of the hotspot.
struct Teams<'p, 'm> {
    problem: &'p Problem<'m>,
    count: usize,
    /// The cell of each team before the first step.
    starts: Vec<Cell>,
    /// What a step of each team adds, by the offset of the hotspot from the team.
    hazards: Vec<Vec<f64>>,
}

impl<'p, 'm> Teams<'p, 'm> {
    fn new(problem: &'p Problem<'m>, count: usize) -> Self {
        let uavs = problem.situation.cells.len();
        let first = |team: usize| (team * uavs).div_ceil(count);
        let members = (0..count).map(|team| first(team + 1) - first(team));
        Self {
            problem,
            count,
            starts: (0..count)
                .map(|team| problem.situation.cells[first(team)])
                .collect(),
            hazards: members.map(|members| hazards(problem, members)).collect(),
        }
    }

    /// Returns the team of a UAV.
    fn of(&self, uav: usize) -> usize {
        uav * self.count / self.problem.situation.cells.len()
    }

    /// Returns routes over all hotspots, which are not shortened yet.
    fn nearest_first(&self) -> Routes {
        let hazards = self.hazards.iter().map(|by_offset| by_offset[0]);
        let waits = hazards.map(|hazard| COMPARED / hazard.max(f64::MIN_POSITIVE));
        let all = (0..self.problem.known.len()).collect();
        let waits: Vec<f64> = waits.collect();
        nearest_first(&self.starts, &waits, &self.problem.known, all)
    }

    /// Moves hotspots and reverses parts of routes as long as this shortens the time.
    fn shortened(&self, mut routes: Routes, watch: &mut Watch<'_>) -> Routes {
        let products = self.problem.steps * self.count * self.problem.known.len();
        let mut least = self.time(&routes);
        let mut left = COMPARISONS_MAX;
        let mut shorter = true;
        while shorter {
            shorter = false;
            for change in changes(&routes) {
                if left == 0 || watch.work(products) {
                    return routes;
                }
                left -= 1;
                let mut changed = routes.clone();
                change.apply(&mut changed);
                let time = self.time(&changed);
                if time < least {
                    (routes, least, shorter) = (changed, time, true);
                    break;
                }
            }
        }
        routes
    }

    /// Returns the time of the last confirmation, with a share of the mean time of one.
    fn time(&self, routes: &Routes) -> f64 {
        let mut flight = Flight::new(self, COMPARED);
        let (known, mut sum) = (flight.open as f64, 0.0);
        for step in 1..=self.problem.steps {
            sum += step as f64 * flight.step(self, routes) as f64;
            if flight.open == 0 {
                return step as f64 + MEAN_WEIGHT * sum / known;
            }
        }
        f64::INFINITY
    }

    /// Returns the trajectories of routes, which are repeated.
    fn recorded(&self, routes: &Routes, enough: f64, level: u8) -> Paths {
        let mut recorder = Recorder::new(self.problem, level);
        let mut flight = Flight::new(self, enough);
        while !recorder.is_full() {
            flight.step(self, routes);
            recorder.fly(|uav| flight.targets[self.of(uav)]);
            if flight.open == 0 {
                flight.open_all();
            }
        }
        recorder.finish()
    }
}

/// A flight over the hotspots, in which detections have their expected effect.
struct Flight {
    /// The cell of each team, and the cell that it flies to.
    cells: Vec<Cell>,
    targets: Vec<Cell>,
    /// The hazard of each hotspot so far, and the one that is enough.
    hazards: Vec<f64>,
    enough: f64,
    /// Number of hotspots whose hazard is not enough.
    open: usize,
}

impl Flight {
    fn new(teams: &Teams<'_, '_>, enough: f64) -> Self {
        let known = teams.problem.known.len();
        Self {
            cells: teams.starts.clone(),
            targets: teams.starts.clone(),
            hazards: vec![0.0; known],
            enough,
            open: known,
        }
    }

    fn open_all(&mut self) {
        self.hazards.fill(0.0);
        self.open = self.hazards.len();
    }

    /// Flies one step. Returns the number of hotspots whose hazard is now enough.
    fn step(&mut self, teams: &Teams<'_, '_>, routes: &Routes) -> usize {
        let (known, config) = (&teams.problem.known, teams.problem.model.config());
        for (team, route) in routes.iter().enumerate() {
            let cell = &mut self.cells[team];
            let next = route
                .iter()
                .find(|&&hotspot| self.hazards[hotspot] < self.enough);
            self.targets[team] = next.map_or(*cell, |&hotspot| known[hotspot]);
            let motion = toward(*cell, self.targets[team]);
            *cell = destination(*cell, motion, config.grid_width, config.grid_height);
        }
        let before = self.open;
        for (hazard, &hotspot) in self.hazards.iter_mut().zip(known) {
            if *hazard >= self.enough {
                continue;
            }
            for (cell, by_offset) in self.cells.iter().zip(&teams.hazards) {
                *hazard += by_offset[teams.problem.odds.offset(*cell, hotspot)];
            }
            self.open -= usize::from(*hazard >= self.enough);
        }
        before - self.open
    }
}

/// Returns the hazard of one step of a number of UAVs in one cell, by the offset of a hotspot.
fn hazards(problem: &Problem<'_>, members: usize) -> Vec<f64> {
    let (odds, config) = (&problem.odds, problem.model.config());
    let quorum = config.quorum as usize;
    let offsets =
        (0..config.grid_height).flat_map(|y| (0..config.grid_width).map(move |x| Cell { x, y }));
    offsets
        .map(|offset| {
            let p = odds.detection(odds.highest(), Cell::default(), offset);
            hazard(quorum, members, p)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use core::ops::ControlFlow;

    use std::println;

    use jcas_core::{Config, Model, Preset, Sim};

    use super::*;
    use crate::problem::Situation;
    use crate::targets::Targets;

    /// The best of all orders of one team, by trying each, over the layouts of fifty episodes.
    #[test]
    fn one_team_visits_five_hotspots_in_nearly_the_best_order() {
        let mut go_on = |_| ControlFlow::Continue(());
        let mut watch = Watch::new(&mut go_on);
        let model = Model::new(Config {
            uav_count: 5,
            hotspot_count: 5,
            ..Config::preset(Preset::Paper)
        })
        .unwrap();
        let (mut found, mut greedy, mut best) = (0.0, 0.0, 0.0);
        for seed in 0..50 {
            let mut sim = Sim::new(&model);
            sim.reset(seed);
            let cells: Vec<Cell> = (0..5).map(|h| sim.state().hotspot_cell(h)).collect();
            let targets = Targets::known(&model, &cells).unwrap();
            let problem = Problem::new(&model, &targets, Situation::at_reset(&model)).unwrap();
            let teams = Teams::new(&problem, 1);
            let nearest = teams.nearest_first();
            greedy += teams.time(&nearest);
            found += teams.time(&teams.shortened(nearest, &mut watch));
            let times = orders(5).into_iter().map(|order| teams.time(&vec![order]));
            best += times.fold(f64::INFINITY, f64::min);
        }
        println!("{found} found, {greedy} nearest first, {best} best");
        assert!(best <= found && found < 1.01 * best, "{found} {best}");
        assert!(found < 0.9 * greedy, "{found} {greedy}");
    }

    /// Returns all orders of 0 to n - 1.
    fn orders(n: usize) -> Vec<Vec<usize>> {
        if n == 0 {
            return vec![Vec::new()];
        }
        let shorter = orders(n - 1);
        let places = |order: &Vec<usize>| {
            let order = order.clone();
            (0..n).map(move |place| {
                let mut longer = order.clone();
                longer.insert(place, n - 1);
                longer
            })
        };
        shorter.iter().flat_map(places).collect()
    }
}
