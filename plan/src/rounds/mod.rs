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
//!
//! Batteries are settled in the samples. A member whose battery runs low flies home, charges, and
//! goes on with the round. The charge with which it leaves the depot is part of the rounds.

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::motion::nearest;
use jcas_core::{Cell, Model};
use jcas_policy::memory::save_cell;
use jcas_policy::{MemoryError, MemoryReader};

use crate::anneal::Settings;
use crate::draws::Draws;
use crate::formation::Recorder;
use crate::objective::Expectation;
use crate::paths::Paths;
use crate::problem::Problem;
use crate::routes::nearest_first;

mod charging;
mod crew;
mod race;

use charging::{Charging, Duty};
use race::{Race, hazards};

/// The maximum number of hotspots, whose set is one integer.
const HOTSPOTS_MAX: usize = 64;
/// The maximum number of teams that a component forms.
const TEAMS_MAX: usize = 8;
/// Sampled episodes of each comparison, and of the final figures.
const SAMPLES: usize = 32;
const FINAL_SAMPLES: usize = 200;
/// Moves of the annealing of trajectories that take as long as one comparison of rounds.
const MOVES_PER_COMPARISON: u64 = 10;

/// A member of a team, as it was when the team was formed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Member {
    uav: usize,
    cell: Cell,
    charge_uj: u64,
}

/// A team on its round, from the step at which it was formed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Team {
    members: Vec<Member>,
    first_step: u32,
    /// The hotspots known to the team when it was formed, one bit each.
    known: u64,
    /// Hotspots in the order of its visits.
    route: Vec<usize>,
    charging: Charging,
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
    /// The longest of the samples in steps.
    pub(crate) longest: u32,
    pub(crate) paths: Paths,
}

/// Plans rounds of the movers of a problem, beside the rounds of the others.
///
/// There is none if all hotspots are known. `initial` are the trajectories that the others are
/// assumed to follow.
pub(crate) fn plan(
    problem: &Problem<'_>,
    hotspots: &[Cell],
    known: &[bool],
    others: &[Team],
    initial: &Paths,
    settings: &Settings,
) -> Option<Planned> {
    let movers = &problem.movers;
    if hotspots.len() > HOTSPOTS_MAX || movers.is_empty() {
        return None;
    }
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
        teams.extend_from_slice(others);
        let rounds = Rounds { teams };
        let least = best.as_ref().map_or(f64::INFINITY, |best| best.0);
        let steps = race.times(&rounds, least).expected.steps;
        if steps < least {
            best = Some((steps, rounds, count));
        }
    }
    let (steps, mut rounds, own) = best?;
    let mut least = steps;
    for _ in 0..settings.iterations / MOVES_PER_COMPARISON {
        let mut moved = rounds.clone();
        if !moved.change(own, problem, &mut draws) {
            continue;
        }
        let steps = race.times(&moved, least).expected.steps;
        if steps <= least {
            (rounds, least) = (moved, steps);
        }
    }
    let race = Race::new(problem, hotspots, FINAL_SAMPLES, &mut draws);
    let times = race.times(&rounds, f64::INFINITY);
    let paths = rounds.paths(own, problem, hotspots, initial);
    Some(Planned {
        rounds,
        expected: times.expected,
        longest: times.longest,
        paths,
    })
}

/// Returns the teams that remain without some UAVs. There are none if a UAV is in no team.
pub(crate) fn others(movers: &[usize], shared: Option<&Rounds>, uavs: usize) -> Option<Vec<Team>> {
    if movers.len() == uavs {
        return Some(Vec::new());
    }
    let mut teams = shared?.teams.clone();
    for team in &mut teams {
        team.members.retain(|member| !movers.contains(&member.uav));
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
    let member = |&uav: &usize| Member {
        uav,
        cell: situation.cells[uav],
        charge_uj: situation.charges_uj[uav],
    };
    let part =
        |team: usize| &movers[team * movers.len() / count..(team + 1) * movers.len() / count];
    let mut teams: Vec<Team> = (0..count)
        .map(|team| Team {
            members: part(team).iter().map(member).collect(),
            first_step: situation.step,
            known,
            route: Vec::new(),
            charging: Charging::as_policies(problem.model),
        })
        .collect();
    let hazard = hazards(problem);
    let wait = |team: &Team| 1.0 / hazard[team.members.len()].max(1e-9);
    let starts: Vec<Cell> = teams.iter().map(|team| team.members[0].cell).collect();
    let waits: Vec<f64> = teams.iter().map(wait).collect();
    let routes = nearest_first(&starts, &waits, hotspots, open.to_vec());
    for (team, route) in teams.iter_mut().zip(routes) {
        team.route = route;
    }
    teams
}

impl Rounds {
    pub(crate) fn save(&self, write: &mut dyn FnMut(u64)) {
        write(self.teams.len() as u64);
        for team in &self.teams {
            write(u64::from(team.first_step));
            write(team.known);
            team.charging.save(write);
            write(team.members.len() as u64);
            for member in &team.members {
                write(member.uav as u64);
                save_cell(write, member.cell);
                write(member.charge_uj);
            }
            write(team.route.len() as u64);
            team.route.iter().for_each(|&hotspot| write(hotspot as u64));
        }
    }

    /// Reads what [`Rounds::save`] wrote.
    pub(crate) fn load(
        read: &mut MemoryReader<'_>,
        model: &Model<'_>,
    ) -> Result<Self, MemoryError> {
        if model.hotspot_count() > HOTSPOTS_MAX {
            return Err(MemoryError::Corrupt);
        }
        let teams = (0..read.count()?).map(|_| Team::load(read, model));
        let teams = teams.collect::<Result<_, _>>()?;
        Ok(Self { teams })
    }

    /// Returns where a UAV with this charge flies to from a cell, and whether it senses there.
    ///
    /// There is nothing if it is in no team, or if its team knew all hotspots.
    pub(crate) fn order(
        &self,
        model: &Model<'_>,
        hotspots: &[Cell],
        uav: usize,
        (here, charge_uj): (Cell, u64),
    ) -> Option<(Cell, bool)> {
        let of = |team: &Team| team.members.iter().position(|member| member.uav == uav);
        let (team, place) = self.teams.iter().find_map(|team| Some((team, of(team)?)))?;
        if team.charging.duty(model, here, charge_uj) == Duty::Home {
            return Some((model.depots()[nearest(here, model.depots()).0], false));
        }
        let target = match team.route.first() {
            Some(&hotspot) => hotspots[hotspot],
            None => nearest_open(team.known, hotspots, team.members[place].cell)?,
        };
        Some((target, here.manhattan(target) <= 1))
    }

    /// Makes one random change in the first teams, those of the component that plans. Returns
    /// whether there was any.
    fn change(&mut self, own: usize, problem: &Problem<'_>, draws: &mut Draws) -> bool {
        let (from, to) = (draws.below(own), draws.below(own));
        let kind = draws.below(5);
        let length = self.teams[from].route.len();
        if kind == 0 {
            if from == to || self.teams[from].members.len() < 2 {
                return false;
            }
            let at = draws.below(self.teams[from].members.len());
            let member = self.teams[from].members.swap_remove(at);
            self.teams[to].members.push(member);
        } else if kind == 1 {
            let before = self.teams[from].charging;
            self.teams[from].charging = Charging::drawn(problem.model, draws);
            return self.teams[from].charging != before;
        } else if length == 0 {
            return false;
        } else if kind == 2 {
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
        true
    }

    /// Returns trajectories of the movers to the first hotspots of their teams, where they stay as
    /// long as their batteries last.
    fn paths(
        &self,
        own: usize,
        problem: &Problem<'_>,
        hotspots: &[Cell],
        initial: &Paths,
    ) -> Paths {
        let odds = &problem.odds;
        let mut moves = vec![false; problem.situation.cells.len()];
        for member in self.teams[..own].iter().flat_map(|team| &team.members) {
            moves[member.uav] = true;
        }
        let mut recorder = Recorder::new(problem, odds.highest());
        while !recorder.is_full() {
            let step = recorder.step() + 1;
            let order = |uav: usize| {
                let at = (recorder.cell(uav), recorder.charge_uj(uav));
                let own = moves[uav].then(|| self.order(problem.model, hotspots, uav, at));
                match own.flatten() {
                    Some((target, senses)) => (target, if senses { odds.highest() } else { 0 }),
                    None => (odds.cell(initial.cell(uav, step)), initial.level(uav, step)),
                }
            };
            let orders: Vec<(Cell, u8)> = (0..moves.len()).map(order).collect();
            recorder.fly_as(|uav| orders[uav]);
        }
        recorder.finish()
    }
}

impl Team {
    fn load(read: &mut MemoryReader<'_>, model: &Model<'_>) -> Result<Self, MemoryError> {
        let first_step = read.below(u64::from(model.config().horizon_steps))? as u32;
        let (known, charging) = (read.word()?, Charging::load(read)?);
        let mut members = Vec::new();
        for _ in 0..read.count()? {
            members.push(Member {
                uav: read.index(model.uav_count())?,
                cell: read.cell(model)?,
                charge_uj: read.word()?,
            });
        }
        if members.is_empty() {
            return Err(MemoryError::Corrupt);
        }
        let route = (0..read.count()?).map(|_| read.index(model.hotspot_count()));
        Ok(Self {
            members,
            first_step,
            known,
            route: route.collect::<Result<_, _>>()?,
            charging,
        })
    }
}

fn nearest_open(known: u64, hotspots: &[Cell], from: Cell) -> Option<Cell> {
    let open = (0..hotspots.len()).filter(|&hotspot| known >> hotspot & 1 == 0);
    open.map(|hotspot| hotspots[hotspot])
        .min_by_key(|cell| from.manhattan(*cell))
}
