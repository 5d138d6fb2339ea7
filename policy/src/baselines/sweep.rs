//! `sweep`: boustrophedon coverage of the grid in lanes.

use jcas_core::motion::toward;
use jcas_core::{Cell, Model, Motion, StateRef};

use super::memory::{OutOfMemory, filled, push};
use super::pilot::PilotMode;
use super::quorum::quorum_probability;
use super::steering::{Steering, can_fly};

/// The maximum distance from a lane, in cells, at which detection is taken into account.
const REACH_CELLS: u32 = 4;

/// Teams that sweep the grid lane by lane, in alternating directions, and turn back at the end.
///
/// Each team has a band of the grid and flies together, since a quorum has to detect in the same
/// step. The number of teams and the spacing of lanes are chosen once for each episode. The choice
/// maximises the probability that a hotspot in a random cell is confirmed within the horizon.
#[derive(Clone, Debug)]
pub struct Sweep {
    pilot: PilotMode,
    teams: Vec<Team>,
}

#[derive(Clone, Debug)]
struct Team {
    uavs: core::ops::Range<usize>,
    path: Vec<Cell>,
    next: usize,
    forward: bool,
    under_way: bool,
}

impl Sweep {
    /// Builds the policy for the pilot density of the teams, which decides their lanes.
    #[must_use]
    pub fn new(pilot: PilotMode) -> Self {
        Self {
            pilot,
            teams: Vec::new(),
        }
    }
}

impl Steering for Sweep {
    fn reset(&mut self, model: &Model<'_>, _seed: u64) -> Result<(), OutOfMemory> {
        let config = model.config();
        let (across, along) = (
            config.grid_width.min(config.grid_height),
            config.grid_width.max(config.grid_height),
        );
        let density = self.pilot.sensing_density(model);
        let (teams, spacing) = choose(model, density, across, along);
        let uavs = model.uav_count();
        self.teams.clear();
        for team in 0..teams {
            let band =
                team as u32 * across / teams as u32..(team as u32 + 1) * across / teams as u32;
            let team = Team {
                uavs: team * uavs / teams..(team + 1) * uavs / teams,
                path: lanes(band, spacing, along, config.grid_width > config.grid_height)?,
                next: 0,
                forward: true,
                under_way: false,
            };
            push(&mut self.teams, team)?;
        }
        Ok(())
    }

    fn steer(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory> {
        let quorum = model.config().quorum as usize;
        for team in &mut self.teams {
            let flying = team.uavs.clone().filter(|&uav| can_fly(state, uav));
            team.advance(flying.map(|uav| state.cell(uav)), quorum);
            for uav in team.uavs.clone() {
                motions[uav] = toward(state.cell(uav), team.path[team.next]);
            }
        }
        Ok(())
    }
}

impl Team {
    /// Advances along the path once enough UAVs of the team are in the present cell. Enough are
    /// most of those that can fly, and at least a quorum if they are that many. The path begins at
    /// its nearer end.
    fn advance(&mut self, flying: impl Iterator<Item = Cell> + Clone, quorum: usize) {
        let Some(first) = flying.clone().next() else {
            return;
        };
        let last = self.path.len() - 1;
        if !self.under_way {
            self.under_way = true;
            self.forward = first.manhattan(self.path[0]) <= first.manhattan(self.path[last]);
            self.next = if self.forward { 0 } else { last };
        }
        let here = self.path[self.next];
        let arrived = flying.clone().filter(|&cell| cell == here).count();
        let count = flying.count();
        let enough = (count / 2 + 1).max(quorum.min(count));
        if arrived < enough || last == 0 {
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

/// Returns the cells of the lanes of a band, every second lane reversed, with the cells between two
/// lanes.
fn lanes(
    band: core::ops::Range<u32>,
    spacing: u32,
    along: u32,
    transposed: bool,
) -> Result<Vec<Cell>, OutOfMemory> {
    let width = band.end - band.start;
    let count = width.div_ceil(spacing);
    let between = spacing.saturating_sub(1);
    // The lanes are centred, which minimises the distance of the edges of the band from a lane.
    let margin = (width - 1 - (count - 1) * spacing) / 2;
    let cells = count * along + (count - 1) * between;
    let mut path = filled(Cell::default(), cells as usize)?;
    for (place, cell) in (0..).zip(&mut path) {
        let (lane, step) = (place / (along + between), place % (along + between));
        // The path follows the lane, then crosses from its end to the next.
        let (along_it, across) = (step.min(along - 1), step.saturating_sub(along - 1));
        *cell = Cell {
            x: band.start + margin + lane * spacing + across,
            y: if lane % 2 == 0 {
                along_it
            } else {
                along - 1 - along_it
            },
        };
    }
    if transposed {
        for cell in &mut path {
            *cell = Cell {
                x: cell.y,
                y: cell.x,
            };
        }
    }
    Ok(path)
}

/// Returns the number of teams and the spacing of lanes with the best chance; the fewest teams
/// among equals.
fn choose(model: &Model<'_>, density: f64, across: u32, along: u32) -> (usize, u32) {
    let teams_max =
        (model.uav_count() / (model.config().quorum as usize).max(1)).clamp(1, across as usize);
    let spacing_max = (2 * REACH_CELLS + 1).min(across);
    let mut best = (1, 1);
    let mut best_chance = -1.0;
    for teams in 1..=teams_max {
        for spacing in 1..=spacing_max.min(across / teams as u32) {
            let chance = chance(model, density, across, along, teams, spacing);
            if chance > best_chance {
                (best, best_chance) = ((teams, spacing), chance);
            }
        }
    }
    best
}

/// Returns the probability that a hotspot in a random cell is confirmed within the horizon.
///
/// One pass at lateral distance o confirms with c(o) = 1 - prod_a (1 - Q(p(o, a))). Here a runs
/// along the lane, and Q is the probability of a quorum for the team. With k passes within the
/// horizon the probability is 1 - (1 - c)^k. With less than one pass, only that part of the grid is
/// seen.
fn chance(
    model: &Model<'_>,
    density: f64,
    across: u32,
    along: u32,
    teams: usize,
    spacing: u32,
) -> f64 {
    let quorum = model.config().quorum as usize;
    let team = model.uav_count() / teams;
    let band = across.div_ceil(teams as u32);
    let pass_steps = f64::from(band.div_ceil(spacing) * along + band - 1);
    let passes = f64::from(model.config().horizon_steps) / pass_steps;
    let reach = REACH_CELLS.min(along - 1);
    let confirmed_at = |offset: u32| {
        let missed_from = |along: u32| {
            // Probabilities depend on the distance alone, so `along` is measured on the longer side
            // of the grid, which has room for it.
            let detection = if model.config().grid_width > model.config().grid_height {
                model.detection_probability(along, offset, density)
            } else {
                model.detection_probability(offset, along, density)
            };
            1.0 - quorum_probability(team, quorum, detection)
        };
        // The cells before and after the hotspot count alike, hence the square.
        let missed: f64 = missed_from(0)
            * (1..=reach)
                .map(|along| {
                    let missed = missed_from(along);
                    missed * missed
                })
                .product::<f64>();
        if passes < 1.0 {
            passes * (1.0 - missed)
        } else {
            1.0 - libm::pow(missed, passes)
        }
    };
    // These are the offsets from the nearest of two lanes that lie `spacing` apart.
    (0..spacing)
        .map(|place| confirmed_at(place.min(spacing - place)))
        .sum::<f64>()
        / f64::from(spacing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_touch_every_cell_once_when_they_lie_side_by_side() {
        let path = lanes(2..7, 1, 9, false).unwrap();
        assert_eq!(path.len(), 5 * 9);
        for pair in path.windows(2) {
            assert_eq!(pair[0].manhattan(pair[1]), 1);
        }
        for x in 2..7 {
            for y in 0..9 {
                assert!(path.contains(&Cell { x, y }));
            }
        }
    }

    #[test]
    fn lanes_apart_are_connected_and_within_the_band() {
        for spacing in 1..=6 {
            let path = lanes(3..9, spacing, 5, false).unwrap();
            for pair in path.windows(2) {
                assert_eq!(pair[0].manhattan(pair[1]), 1, "spacing {spacing}");
            }
            assert!(path.iter().all(|cell| (3..9).contains(&cell.x)));
        }
    }
}
