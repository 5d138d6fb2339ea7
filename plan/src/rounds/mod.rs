//! Rounds: teams that visit known hotspots, and stay at each until they know it is confirmed.
//!
//! A trajectory leaves a hotspot after a fixed time, confirmed or not. Where the radar reaches no
//! farther than its own cell, this wastes most of the visits. A team that stays until it knows of
//! the confirmation never leaves in vain. Its time is random, so rounds are simulated on
//! sampled waits, with the same samples for all rounds that are compared.
//!
//! A team of m UAVs over a hotspot reaches the quorum in a step with probability q(m). The wait is
//! a race: each step adds -ln(1 - q(m)) to a sum, until the sum reaches -ln(U) with U uniform in
//! (0, 1]. Teams over the same hotspot add up, and teams in radio contact share what they know.

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::{Cell, Model};
use jcas_policy::memory::save_cell;
use jcas_policy::{MemoryError, MemoryReader};

use crate::anneal::Settings;
use crate::battery;
use crate::draws::Draws;
use crate::formation::Recorder;
use crate::objective::Expectation;
use crate::paths::Paths;
use crate::problem::Problem;
use crate::routes::nearest_first;

mod race;

use race::{Race, hazards};

/// The maximum number of hotspots, whose set is one integer.
const HOTSPOTS_MAX: usize = 64;
/// The maximum number of teams that a component forms.
const TEAMS_MAX: usize = 8;
/// Sampled episodes of each comparison, and of the final figures.
const SAMPLES: usize = 32;
const FINAL_SAMPLES: usize = 200;
/// Moves of the annealing of trajectories that take as long as one comparison of rounds.
const MOVES_PER_COMPARISON: u64 = 40;

/// A team on its round, from the step at which it was formed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Team {
    members: Vec<usize>,
    cell: Cell,
    first_step: u32,
    /// The hotspots known to the team when it was formed, one bit each.
    known: u64,
    /// Hotspots in the order of its visits.
    route: Vec<usize>,
}

/// The rounds of all teams of a fleet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Rounds {
    teams: Vec<Team>,
}

/// Rounds with their expected time, and the trajectories of the teams up to the next confirmation.
pub(crate) struct Planned {
    pub(crate) rounds: Rounds,
    pub(crate) expected: Expectation,
    pub(crate) paths: Paths,
}

/// Plans rounds of the movers of a problem. Other UAVs go on with their shared rounds.
///
/// There is none if a battery may run low, or if UAVs are neither movers nor on shared rounds.
/// `initial` are the trajectories that the others are assumed to follow.
pub(crate) fn plan(
    problem: &Problem<'_>,
    hotspots: &[Cell],
    known: &[bool],
    shared: Option<&Rounds>,
    initial: &Paths,
    settings: &Settings,
) -> Option<Planned> {
    let (situation, steps) = (&problem.situation, problem.steps_left as usize);
    let lasts = |&uav: &usize| battery::never_low(problem.model, situation.charges_uj[uav], steps);
    let movers = &problem.movers;
    if hotspots.len() > HOTSPOTS_MAX || movers.is_empty() || !movers.iter().all(lasts) {
        return None;
    }
    let others = others(movers, shared, situation.cells.len())?;
    let known = bits(known);
    let open: Vec<usize> = (0..hotspots.len())
        .filter(|&h| known >> h & 1 == 0)
        .collect();
    if open.is_empty() {
        return None;
    }
    let mut draws = Draws::new(settings.seed);
    let race = Race::new(problem, hotspots, SAMPLES, &mut draws);
    let mut best: Option<(f64, Rounds, usize)> = None;
    let most = (movers.len() / problem.model.config().quorum as usize).max(1);
    for count in 1..=most.min(open.len()).min(TEAMS_MAX) {
        let mut teams = form(problem, hotspots, &open, known, count);
        teams.extend(others.iter().cloned());
        let rounds = Rounds { teams };
        let steps = race.expect(&rounds).steps;
        if best.as_ref().is_none_or(|best| steps < best.0) {
            best = Some((steps, rounds, count));
        }
    }
    let (steps, mut rounds, own) = best?;
    let mut least = steps;
    for _ in 0..settings.iterations / MOVES_PER_COMPARISON {
        let mut moved = rounds.clone();
        if !moved.change(own, problem, hotspots, &mut draws) {
            continue;
        }
        let steps = race.expect(&moved).steps;
        if steps <= least {
            (rounds, least) = (moved, steps);
        }
    }
    let expected = Race::new(problem, hotspots, FINAL_SAMPLES, &mut draws).expect(&rounds);
    let paths = rounds.paths(own, problem, hotspots, initial);
    Some(Planned {
        rounds,
        expected,
        paths,
    })
}

/// Returns the teams that remain without some UAVs. There are none if a UAV is in no team.
fn others(movers: &[usize], shared: Option<&Rounds>, uavs: usize) -> Option<Vec<Team>> {
    if movers.len() == uavs {
        return Some(Vec::new());
    }
    let mut teams = shared?.teams.clone();
    for team in &mut teams {
        team.members.retain(|uav| !movers.contains(uav));
    }
    teams.retain(|team| !team.members.is_empty());
    let members: usize = teams.iter().map(|team| team.members.len()).sum();
    (members + movers.len() == uavs).then_some(teams)
}

fn bits(flags: &[bool]) -> u64 {
    let set = flags.iter().take(HOTSPOTS_MAX).enumerate();
    set.fold(0, |bits, (index, &flag)| bits | u64::from(flag) << index)
}

/// Forms teams of nearly equal size. The team that is free first takes the hotspot nearest to it.
fn form(
    problem: &Problem<'_>,
    hotspots: &[Cell],
    open: &[usize],
    known: u64,
    count: usize,
) -> Vec<Team> {
    let situation = &problem.situation;
    let mut movers = problem.movers.clone();
    movers.sort_by_key(|&uav| (problem.odds.index(situation.cells[uav]), uav));
    let first_step = situation.step;
    let mut teams: Vec<Team> = (0..count)
        .map(|team| {
            let members =
                movers[team * movers.len() / count..(team + 1) * movers.len() / count].to_vec();
            Team {
                cell: situation.cells[members[0]],
                members,
                first_step,
                known,
                route: Vec::new(),
            }
        })
        .collect();
    let hazard = hazards(problem);
    let wait = |team: &Team| 1.0 / hazard[team.members.len()].max(1e-9);
    let starts: Vec<Cell> = teams.iter().map(|team| team.cell).collect();
    let waits: Vec<f64> = teams.iter().map(wait).collect();
    let routes = nearest_first(&starts, &waits, hotspots, open.to_vec());
    for (team, route) in teams.iter_mut().zip(routes) {
        team.route = route;
    }
    for team in &mut teams {
        team.settle(problem, hotspots);
    }
    teams
}

impl Rounds {
    pub(crate) fn save(&self, write: &mut dyn FnMut(u64)) {
        write(self.teams.len() as u64);
        for team in &self.teams {
            save_cell(write, team.cell);
            write(u64::from(team.first_step));
            write(team.known);
            for list in [&team.members, &team.route] {
                write(list.len() as u64);
                list.iter().for_each(|&index| write(index as u64));
            }
        }
    }

    /// Reads what [`Rounds::save`] wrote.
    pub(crate) fn load(
        read: &mut MemoryReader<'_>,
        model: &Model<'_>,
    ) -> Result<Self, MemoryError> {
        let hotspots = model.hotspot_count();
        if hotspots > HOTSPOTS_MAX {
            return Err(MemoryError::Corrupt);
        }
        let mut teams = Vec::new();
        for _ in 0..read.count()? {
            let (cell, first_step) = (
                read.cell(model)?,
                read.below(u64::from(model.config().horizon_steps))? as u32,
            );
            let known = read.word()?;
            let mut list = |limit: usize| -> Result<Vec<usize>, MemoryError> {
                (0..read.count()?).map(|_| read.index(limit)).collect()
            };
            let (members, route) = (list(model.uav_count())?, list(hotspots)?);
            if members.is_empty() {
                return Err(MemoryError::Corrupt);
            }
            teams.push(Team {
                members,
                cell,
                first_step,
                known,
                route,
            });
        }
        Ok(Self { teams })
    }
}

impl Team {
    /// Takes the member that is farthest from the first hotspot for the team's cell.
    fn settle(&mut self, problem: &Problem<'_>, hotspots: &[Cell]) {
        let cells = &problem.situation.cells;
        let target = self
            .route
            .first()
            .map_or(cells[self.members[0]], |&h| hotspots[h]);
        let farthest = self
            .members
            .iter()
            .max_by_key(|&&uav| cells[uav].manhattan(target));
        self.cell = farthest.map_or(target, |&uav| cells[uav]);
    }
}

impl Rounds {
    /// Makes one random change in the first teams, those of the component that plans. Returns
    /// whether there was any.
    fn change(
        &mut self,
        own: usize,
        problem: &Problem<'_>,
        hotspots: &[Cell],
        draws: &mut Draws,
    ) -> bool {
        let (from, to) = (draws.below(own), draws.below(own));
        let kind = draws.below(4);
        let length = self.teams[from].route.len();
        if kind == 0 {
            if from == to || self.teams[from].members.len() < 2 {
                return false;
            }
            let at = draws.below(self.teams[from].members.len());
            let uav = self.teams[from].members.swap_remove(at);
            self.teams[to].members.push(uav);
        } else if length == 0 {
            return false;
        } else if kind == 1 {
            let (a, b) = (draws.below(length), draws.below(length));
            if a == b {
                return false;
            }
            self.teams[from].route[a.min(b)..=a.max(b)].reverse();
        } else {
            let hotspot = self.teams[from].route.remove(draws.below(length));
            let place = draws.below(self.teams[to].route.len() + 1);
            self.teams[to].route.insert(place, hotspot);
        }
        self.teams[from].settle(problem, hotspots);
        self.teams[to].settle(problem, hotspots);
        true
    }

    /// Returns trajectories that fly each mover to the first hotspot of its team, to stay there.
    fn paths(
        &self,
        own: usize,
        problem: &Problem<'_>,
        hotspots: &[Cell],
        initial: &Paths,
    ) -> Paths {
        let odds = &problem.odds;
        let mut targets = vec![None; problem.situation.cells.len()];
        for team in &self.teams[..own] {
            for &uav in &team.members {
                let target = team.route.first().map(|&hotspot| hotspots[hotspot]);
                targets[uav] = target.or_else(|| nearest_open(team.known, hotspots, team.cell));
            }
        }
        let mut recorder = Recorder::new(problem, odds.highest());
        while !recorder.is_full() {
            let step = recorder.step() + 1;
            let cells: Vec<Cell> = (0..targets.len()).map(|uav| recorder.cell(uav)).collect();
            recorder.fly_as(|uav| match targets[uav] {
                Some(target) if cells[uav].manhattan(target) > 1 => (target, 0),
                Some(target) => (target, odds.highest()),
                None => (odds.cell(initial.cell(uav, step)), initial.level(uav, step)),
            });
        }
        recorder.finish()
    }
}

fn nearest_open(known: u64, hotspots: &[Cell], from: Cell) -> Option<Cell> {
    let open = (0..hotspots.len()).filter(|&hotspot| known >> hotspot & 1 == 0);
    open.map(|hotspot| hotspots[hotspot])
        .min_by_key(|cell| from.manhattan(*cell))
}
