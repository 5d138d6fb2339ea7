//! `teams`: teams of at least the quorum, assigned to hotspots by least total distance.

use jcas_core::motion::toward;
use jcas_core::{Cell, Model, Motion, StateRef};

use super::assignment::cheapest;
use super::division::Division;
use super::memory::{OutOfMemory, collect, filled, push};
use super::pilot::PilotMode;
use super::quorum::quorum_probability;
use super::route::route;
use super::steering::{Steering, can_fly};
use crate::memory::save_cell;
use crate::{MemoryError, MemoryReader};

/// The maximum number of UAVs with an optimal assignment, which costs the cube of their number.
/// Larger fleets keep the teams as they were formed, nearest first.
const OPTIMAL_ASSIGNMENT_UAVS_MAX: usize = 256;

/// The maximum number of teams, which bounds the cost of planning for very large fleets.
const TEAMS_MAX: usize = 64;

/// Teams of at least the quorum, which divide the hotspots where that is quicker than flying
/// together.
///
/// The plan is made anew when a hotspot is confirmed, or when a UAV starts or stops flying:
/// 1. The time of each division is forecast from the mean waits for a quorum. One team takes the
///    shortest route through all hotspots left ([`route()`]), and several teams the nearest next.
///    The division that finishes first is taken.
/// 2. Teams take hotspots one after the other: first the hotspot with the nearest team.
/// 3. UAVs are assigned to teams for the least total distance (Kuhn and Munkres).
#[derive(Clone, Debug)]
pub struct Teams {
    pilot: PilotMode,
    target_of_uav: Vec<Option<Cell>>,
    situation: Situation,
    /// Whether the targets belong to the present situation.
    planned: bool,
}

/// The state that a plan depends on.
#[derive(Clone, Debug, Default)]
struct Situation {
    confirmed: Vec<bool>,
    flying: Vec<bool>,
}

/// A hotspot, and the number of UAVs sent there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Errand {
    target: Cell,
    team: usize,
}

impl Teams {
    /// Builds the policy for the pilot density of the teams, which decides their size.
    #[must_use]
    pub fn new(pilot: PilotMode) -> Self {
        Self {
            pilot,
            target_of_uav: Vec::new(),
            situation: Situation::default(),
            planned: false,
        }
    }

    fn plan(&mut self, model: &Model<'_>, state: &StateRef<'_>) -> Result<(), OutOfMemory> {
        let uavs = indices(&self.situation.flying, true)?;
        let cells = collect(uavs.iter().map(|&uav| state.cell(uav)))?;
        let left = indices(&self.situation.confirmed, false)?;
        let left = collect(left.iter().map(|&hotspot| state.hotspot_cell(hotspot)))?;
        self.target_of_uav.fill(None);
        if uavs.is_empty() || left.is_empty() {
            return Ok(());
        }
        let plan = divide(model, self.pilot, &cells, &left, Effort::Plain)?;
        for (&uav, target) in uavs.iter().zip(plan.targets(&left)) {
            self.target_of_uav[uav] = Some(target);
        }
        Ok(())
    }
}

impl Steering for Teams {
    fn reset(&mut self, model: &Model<'_>) -> Result<(), OutOfMemory> {
        self.target_of_uav = filled(None, model.uav_count())?;
        self.situation = Situation {
            confirmed: filled(false, model.hotspot_count())?,
            flying: filled(false, model.uav_count())?,
        };
        self.planned = false;
        Ok(())
    }

    fn save(&self, write: &mut dyn FnMut(u64)) {
        write(u64::from(self.planned));
        let flags = self
            .situation
            .confirmed
            .iter()
            .chain(&self.situation.flying);
        flags.for_each(|&flag| write(u64::from(flag)));
        self.target_of_uav
            .iter()
            .for_each(|&target| save_target(write, target));
    }

    fn load(&mut self, model: &Model<'_>, read: &mut MemoryReader<'_>) -> Result<(), MemoryError> {
        self.planned = read.flag()?;
        let Situation { confirmed, flying } = &mut self.situation;
        for flag in confirmed.iter_mut().chain(flying) {
            *flag = read.flag()?;
        }
        for target in &mut self.target_of_uav {
            *target = load_target(model, read)?;
        }
        Ok(())
    }

    fn steer(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory> {
        let confirmed = |hotspot| state.confirmed(hotspot);
        let changed = update(&mut self.situation.confirmed, confirmed)
            | update(&mut self.situation.flying, |uav| can_fly(state, uav));
        self.planned &= !changed;
        if !self.planned {
            self.plan(model, state)?;
            self.planned = true;
        }
        for (uav, motion) in motions.iter_mut().enumerate() {
            *motion = self.target_of_uav[uav]
                .map_or(Motion::Stay, |target| toward(state.cell(uav), target));
        }
        Ok(())
    }
}

/// Writes the cell that a UAV flies to, if any, as two words.
pub(super) fn save_target(write: &mut dyn FnMut(u64), target: Option<Cell>) {
    write(u64::from(target.is_some()));
    save_cell(write, target.unwrap_or_default());
}

pub(super) fn load_target(
    model: &Model<'_>,
    read: &mut MemoryReader<'_>,
) -> Result<Option<Cell>, MemoryError> {
    let (some, cell) = (read.flag()?, read.cell(model)?);
    Ok(some.then_some(cell))
}

/// Sets each flag anew. Returns whether any has changed.
fn update(flags: &mut [bool], now: impl Fn(usize) -> bool) -> bool {
    let mut changed = false;
    for (index, flag) in flags.iter_mut().enumerate() {
        let now = now(index);
        changed |= *flag != now;
        *flag = now;
    }
    changed
}

fn indices(flags: &[bool], wanted: bool) -> Result<Vec<usize>, OutOfMemory> {
    collect((0..flags.len()).filter(|&index| flags[index] == wanted))
}

/// The division of UAVs and hotspots among teams.
pub(super) struct Teamwork {
    /// The team of each UAV.
    pub(super) team_of_uav: Vec<usize>,
    /// The hotspots of each team in the order of its visits. There is at least one.
    pub(super) routes: Vec<Vec<usize>>,
}

impl Teamwork {
    /// Returns the hotspot that each UAV flies to, of the hotspots that were divided.
    pub(super) fn targets(&self, hotspots: &[Cell]) -> impl Iterator<Item = Cell> {
        let target = |&team: &usize| hotspots[self.routes[team][0]];
        self.team_of_uav.iter().map(target)
    }
}

/// How divisions are made and compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    /// Several teams fly to the nearest hotspot next, and every wait takes its mean.
    Plain,
    /// Routes are improved, and waits are random.
    Thorough,
}

/// Returns the division that is forecast to finish first. There is at least one UAV and one hotspot
/// left.
pub(super) fn divide(
    model: &Model<'_>,
    pilot: PilotMode,
    uavs: &[Cell],
    left: &[Cell],
    effort: Effort,
) -> Result<Teamwork, OutOfMemory> {
    let quorum = model.config().quorum as usize;
    let detection = model.detection_probability(0, 0, pilot.sensing_density(model));
    let wait = |team: usize| 1.0 / quorum_probability(team, quorum, detection).max(1e-9);

    // A single team takes the shortest route through all hotspots.
    let (order, steps) = route(centroid(uavs), left)?;
    let mut best_steps = f64::from(steps) + left.len() as f64 * wait(uavs.len());
    let mut best = Teamwork {
        team_of_uav: filled(0, uavs.len())?,
        routes: collect(std::iter::once(order))?,
    };
    let mut consider = |errands: &[Errand], team_of_uav: Vec<usize>| {
        let firsts = errands.iter().map(|errand| (errand.team, errand.target));
        let mut division = Division::nearest_next(left, uavs, &team_of_uav, firsts, &wait)?;
        let steps = match effort {
            Effort::Plain => division.steps(),
            Effort::Thorough => division.improve(),
        };
        if steps < best_steps {
            best_steps = steps;
            best = Teamwork {
                team_of_uav,
                routes: collect(division.teams.into_iter().map(|team| team.route))?,
            };
        }
        Ok::<(), OutOfMemory>(())
    };
    let most = left.len().min(uavs.len() / quorum.max(1)).min(TEAMS_MAX);
    // Every small number of teams is tried; above, each number is half as large again as the last.
    let numbers = std::iter::successors(Some(2), |&teams| Some((teams + 1).max(teams * 3 / 2 - 3)));
    for teams in numbers.take_while(|&teams| teams <= most) {
        let (errands, team_of_uav) = choose_errands(uavs, left, teams)?;
        consider(&errands, team_of_uav)?;
    }
    if uavs.len() <= OPTIMAL_ASSIGNMENT_UAVS_MAX {
        best.team_of_uav = assign(uavs, left, &best)?;
    }
    Ok(best)
}

/// Returns the cell nearest to the mean position.
fn centroid(uavs: &[Cell]) -> Cell {
    let mean = |of: fn(&Cell) -> u32| {
        let sum: u64 = uavs.iter().map(|cell| u64::from(of(cell))).sum();
        ((sum + uavs.len() as u64 / 2) / uavs.len() as u64) as u32
    };
    Cell {
        x: mean(|cell| cell.x),
        y: mean(|cell| cell.y),
    }
}

/// Forms teams of equal size, one after the other. Each takes the hotspot left with the least total
/// distance to its nearest free UAVs. Returns the errands, and the index of each UAV's errand.
fn choose_errands(
    uavs: &[Cell],
    left: &[Cell],
    teams: usize,
) -> Result<(Vec<Errand>, Vec<usize>), OutOfMemory> {
    let (mut groups, next) = groups(uavs)?;
    let mut errands: Vec<Errand> = Vec::new();
    let mut errand_of = filled(0, uavs.len())?;
    for number in 0..teams {
        let team = uavs.len() / teams + usize::from(number < uavs.len() % teams);
        let nearest = left
            .iter()
            .filter(|&&target| errands.iter().all(|errand| errand.target != target))
            .min_by_key(|&&target| steps_to(target, &mut groups, team));
        let Some(&target) = nearest else { break };
        sort(&mut groups, target);
        let free = groups.iter_mut().flat_map(|group| group.take(&next));
        for uav in free.take(team) {
            errand_of[uav] = number;
        }
        push(&mut errands, Errand { target, team })?;
    }
    Ok((errands, errand_of))
}

/// UAVs in one cell that have no errand yet. They are interchangeable, and most fleets fly in few
/// cells.
struct Group {
    cell: Cell,
    /// Number of UAVs.
    count: usize,
    /// Index of the first UAV.
    first: usize,
    /// Sort key: the distance from a target, then the place before sorting.
    key: u64,
}

impl Group {
    /// Takes the UAVs one after the other.
    fn take(&mut self, next: &[usize]) -> impl Iterator<Item = usize> {
        std::iter::from_fn(move || {
            self.count = self.count.checked_sub(1)?;
            let uav = self.first;
            self.first = next[uav];
            Some(uav)
        })
    }
}

/// Returns the groups, and for each UAV the next one of its group.
fn groups(uavs: &[Cell]) -> Result<(Vec<Group>, Vec<usize>), OutOfMemory> {
    let mut groups: Vec<Group> = Vec::new();
    let mut next = filled(0, uavs.len())?;
    for (uav, &cell) in uavs.iter().enumerate().rev() {
        if let Some(group) = groups.iter_mut().find(|group| group.cell == cell) {
            next[uav] = group.first;
            group.first = uav;
            group.count += 1;
        } else {
            let group = Group {
                cell,
                count: 1,
                first: uav,
                key: 0,
            };
            push(&mut groups, group)?;
        }
    }
    Ok((groups, next))
}

/// Sorts the groups by distance from a target; groups at equal distance keep their order.
fn sort(groups: &mut [Group], target: Cell) {
    for (place, group) in (0..).zip(groups.iter_mut()) {
        group.key = u64::from(group.cell.manhattan(target)) << 32 | place;
    }
    groups.sort_unstable_by_key(|group| group.key);
}

/// Returns the total distance, in steps, of the nearest `team` free UAVs.
fn steps_to(target: Cell, groups: &mut [Group], team: usize) -> u64 {
    sort(groups, target);
    let (mut missing, mut steps) = (team, 0);
    for group in groups {
        let taken = group.count.min(missing);
        steps += taken as u64 * u64::from(group.cell.manhattan(target));
        missing -= taken;
    }
    steps
}

/// Returns the team of each UAV for the least total distance; every team keeps its size.
fn assign(uavs: &[Cell], left: &[Cell], plan: &Teamwork) -> Result<Vec<usize>, OutOfMemory> {
    let mut seats = collect(plan.team_of_uav.iter().copied())?;
    seats.sort_unstable();
    let size = uavs.len();
    let mut distances = filled(0, size * size)?;
    for (row, uav) in distances.chunks_exact_mut(size).zip(uavs) {
        for (distance, &seat) in row.iter_mut().zip(&seats) {
            *distance = i64::from(uav.manhattan(left[plan.routes[seat][0]]));
        }
    }
    let mut seat_of_uav = cheapest(&distances, size)?;
    for seat in &mut seat_of_uav {
        *seat = seats[*seat];
    }
    Ok(seat_of_uav)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(x: u32, y: u32) -> Cell {
        Cell { x, y }
    }

    #[test]
    fn teams_are_of_equal_size_and_take_the_nearest_hotspots() {
        let uavs = [cell(0, 0), cell(9, 9), cell(0, 1), cell(9, 8), cell(1, 0)];
        let left = [cell(5, 5), cell(9, 9), cell(0, 0)];
        let (errands, errand_of) = choose_errands(&uavs, &left, 2).unwrap();
        assert_eq!(
            errands[0],
            Errand {
                target: cell(0, 0),
                team: 3
            }
        );
        assert_eq!(
            errands[1],
            Errand {
                target: cell(9, 9),
                team: 2
            }
        );
        assert_eq!(errand_of, [0, 1, 0, 1, 0]);
    }

    #[test]
    fn the_assignment_has_the_least_total_distance() {
        let uavs = [cell(0, 0), cell(2, 0), cell(4, 0), cell(6, 0)];
        let plan = Teamwork {
            team_of_uav: vec![0, 1, 0, 1],
            routes: vec![vec![1], vec![0]],
        };
        let left = [cell(1, 0), cell(6, 0)];
        assert_eq!(assign(&uavs, &left, &plan).unwrap(), [1, 1, 0, 0]);
    }
}
