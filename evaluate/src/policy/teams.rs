//! `teams`: teams of at least the quorum, assigned to hotspots by least total distance.

use jcas_core::motion::toward;
use jcas_core::{Cell, Model, Motion, StateRef};
use pathfinding::matrix::Matrix;
use pathfinding::prelude::kuhn_munkres_min;

use super::baseline::{Steering, can_fly};
use super::pilot::PilotMode;
use super::quorum::quorum_probability;

/// Above this many UAVs the assignment keeps the teams as they were formed, nearest first: the optimal
/// one costs the cube of their number.
const OPTIMAL_ASSIGNMENT_UAVS_MAX: usize = 256;

/// Divides the fleet over several hotspots where that is quicker than flying together.
///
/// Planned anew whenever a hotspot is confirmed or a UAV begins or ceases to fly:
/// 1. how many teams: see [`team_count`];
/// 2. which hotspots: one after the other the one whose nearest team is nearest;
/// 3. who flies where: least total distance over all UAVs (Kuhn and Munkres).
#[derive(Clone, Debug)]
pub struct Teams {
    pilot: PilotMode,
    target_of_uav: Vec<Option<Cell>>,
    planned_for: Option<Situation>,
}

/// What a plan depends on.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Situation {
    confirmed: Vec<bool>,
    flying: Vec<bool>,
}

/// A hotspot and how many UAVs are sent there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Errand {
    target: Cell,
    team: usize,
}

impl Teams {
    /// With the pilot density that the teams will sense with, which decides how large they have to be.
    #[must_use]
    pub fn new(pilot: PilotMode) -> Self {
        Self {
            pilot,
            target_of_uav: Vec::new(),
            planned_for: None,
        }
    }

    fn plan(&mut self, model: &Model<'_>, state: &StateRef<'_>, situation: &Situation) {
        let uavs = indices(&situation.flying, true);
        let cells: Vec<Cell> = uavs.iter().map(|&uav| state.cell(uav)).collect();
        let left: Vec<Cell> = indices(&situation.confirmed, false)
            .into_iter()
            .map(|hotspot| state.hotspot_cell(hotspot))
            .collect();
        self.target_of_uav.clear();
        self.target_of_uav.resize(model.uav_count(), None);
        if uavs.is_empty() || left.is_empty() {
            return;
        }
        let teams = team_count(model, self.pilot, uavs.len(), left.len());
        let (errands, formed) = choose_errands(&cells, &left, teams);
        let assigned = if uavs.len() <= OPTIMAL_ASSIGNMENT_UAVS_MAX {
            assign(&cells, &errands)
        } else {
            formed
        };
        for (&uav, errand) in uavs.iter().zip(assigned) {
            self.target_of_uav[uav] = Some(errands[errand].target);
        }
    }
}

impl Steering for Teams {
    fn reset(&mut self, _model: &Model<'_>, _seed: u64) {
        self.planned_for = None;
    }

    fn steer(&mut self, model: &Model<'_>, state: &StateRef<'_>, motions: &mut [Motion]) {
        let situation = Situation {
            confirmed: (0..model.hotspot_count())
                .map(|hotspot| state.confirmed(hotspot))
                .collect(),
            flying: (0..model.uav_count())
                .map(|uav| can_fly(state, uav))
                .collect(),
        };
        if self.planned_for.as_ref() != Some(&situation) {
            self.plan(model, state, &situation);
            self.planned_for = Some(situation);
        }
        for (uav, motion) in motions.iter_mut().enumerate() {
            *motion = self.target_of_uav[uav]
                .map_or(Motion::Stay, |target| toward(state.cell(uav), target));
        }
    }
}

fn indices(flags: &[bool], wanted: bool) -> Vec<usize> {
    (0..flags.len())
        .filter(|&index| flags[index] == wanted)
        .collect()
}

/// How many teams finish first, if each flies to its share of the hotspots one after the other.
///
/// A visit costs a hop and the wait for a quorum, whose mean is one over its probability in a step.
/// The hop is the mean distance between neighbours when `left` hotspots lie on the grid at random.
/// More than one team also has to meet the others in the end: half the grid.
fn team_count(model: &Model<'_>, pilot: PilotMode, uavs: usize, left: usize) -> usize {
    let config = model.config();
    let quorum = config.quorum as usize;
    let detection = model.detection_probability(0, 0, pilot.sensing_density(model));
    let area = f64::from(config.grid_width) * f64::from(config.grid_height);
    let hop = (area / left as f64).sqrt();
    let meeting = f64::from(config.grid_width + config.grid_height) / 4.0;
    let steps = |teams: usize| {
        let wait = 1.0 / quorum_probability(uavs / teams, quorum, detection).max(1e-9);
        let visits = left.div_ceil(teams) as f64;
        visits * (hop + wait) + if teams > 1 { meeting } else { 0.0 }
    };
    (1..=left.min(uavs / quorum.max(1)))
        .min_by(|&a, &b| steps(a).total_cmp(&steps(b)))
        .unwrap_or(1)
}

/// Forms teams of equal size, one after the other: of all hotspots left the one whose nearest free UAVs
/// have the least way to go. Returns the errands and each UAV's.
fn choose_errands(uavs: &[Cell], left: &[Cell], teams: usize) -> (Vec<Errand>, Vec<usize>) {
    let mut errands: Vec<Errand> = Vec::with_capacity(teams);
    let mut errand_of = vec![usize::MAX; uavs.len()];
    for number in 0..teams {
        let team = uavs.len() / teams + usize::from(number < uavs.len() % teams);
        let free = || (0..uavs.len()).filter(|&uav| errand_of[uav] == usize::MAX);
        let nearest = |target: Cell| {
            let mut by_distance: Vec<usize> = free().collect();
            by_distance.sort_by_key(|&uav| uavs[uav].manhattan(target));
            by_distance.truncate(team);
            by_distance
        };
        let best = left
            .iter()
            .filter(|&&target| errands.iter().all(|errand| errand.target != target))
            .map(|&target| (target, nearest(target)))
            .min_by_key(|(target, members)| -> u64 {
                members
                    .iter()
                    .map(|&uav| u64::from(uavs[uav].manhattan(*target)))
                    .sum()
            });
        let Some((target, members)) = best else { break };
        for uav in members {
            errand_of[uav] = number;
        }
        errands.push(Errand { target, team });
    }
    (errands, errand_of)
}

/// The errand of each UAV for the least total distance; every errand gets its number of UAVs.
fn assign(uavs: &[Cell], errands: &[Errand]) -> Vec<usize> {
    let seats: Vec<usize> = errands
        .iter()
        .enumerate()
        .flat_map(|(index, errand)| std::iter::repeat_n(index, errand.team))
        .collect();
    let distances = Matrix::from_fn(uavs.len(), seats.len(), |(uav, seat)| {
        i64::from(uavs[uav].manhattan(errands[seats[seat]].target))
    });
    let (_, seat_of_uav) = kuhn_munkres_min(&distances);
    seat_of_uav.into_iter().map(|seat| seats[seat]).collect()
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
        let (errands, errand_of) = choose_errands(&uavs, &left, 2);
        assert_eq!(errands[0], Errand { target: cell(0, 0), team: 3 });
        assert_eq!(errands[1], Errand { target: cell(9, 9), team: 2 });
        assert_eq!(errand_of, [0, 1, 0, 1, 0]);
    }

    #[test]
    fn the_assignment_has_the_least_total_distance() {
        let uavs = [cell(0, 0), cell(2, 0), cell(4, 0), cell(6, 0)];
        let errands = [
            Errand { target: cell(6, 0), team: 2 },
            Errand { target: cell(1, 0), team: 2 },
        ];
        assert_eq!(assign(&uavs, &errands), [1, 1, 0, 0]);
    }
}
