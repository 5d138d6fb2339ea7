//! `frontier` and `relay`: teams that fly to cells that they have not searched.

use core::ops::Range;

use jcas_core::motion::{destination, toward};
use jcas_core::{Cell, Model, Motion, StateRef};

use super::memory::{OutOfMemory, filled, push};
use super::pilot::PilotMode;
use super::steering::{Steering, can_fly, cell_of};

/// The age of a cell, in steps, that outweighs one step of flight.
const STEPS_PER_CELL: i64 = 2;
/// The bonus of a cell that was never searched, above that of every searched cell.
const UNSEARCHED: i64 = 1 << 30;
/// The penalty for being near the target of another team.
const CROWDED: i64 = 1 << 20;
/// The penalty, for a team that stays connected, of a target out of radio reach of every other
/// target.
const OUT_OF_TOUCH: i64 = 1 << 40;
/// The least distance in cells of the targets of two connected teams, where there is a choice.
const RELAYS_APART_CELLS: u32 = 2;
/// The least distance in cells of the targets of two teams, where there is a choice.
const APART_CELLS: u32 = 4;

/// Teams of θ UAVs, each on its way to the nearest cell that it has not searched, apart from the
/// other teams. When all cells are searched, a team flies to those that it has not seen for
/// longest.
///
/// A team takes the search map of its first UAV that can fly. Without search maps it takes the
/// cells that any UAV has visited. With `connected`, a team chooses among targets within radio
/// reach of another team's. It also gives up a move that would disconnect the fleet.
#[derive(Clone, Debug)]
pub struct Frontier {
    pilot: PilotMode,
    connected: bool,
    teams: Vec<Team>,
    near: Near,
}

/// Working memory, with room for an entry for each team.
#[derive(Clone, Debug, Default)]
struct Near {
    /// Targets of the other teams.
    targets: Vec<Cell>,
    /// Teams that can fly, each with the index of its lead UAV.
    leads: Vec<(usize, usize)>,
    /// The cells of the leads.
    cells: Vec<Cell>,
    /// Working memory of [`Reach::in_one_piece`].
    order: Vec<usize>,
}

#[derive(Clone, Debug)]
struct Team {
    uavs: Range<usize>,
    target: Option<Cell>,
    /// The step at which the team believes each cell was last searched. `None` stands for never.
    looked_at: Vec<Option<u32>>,
}

impl Frontier {
    /// Teams that choose their targets independently of radio links.
    #[must_use]
    pub fn new(pilot: PilotMode) -> Self {
        Self {
            pilot,
            connected: false,
            teams: Vec::new(),
            near: Near::default(),
        }
    }

    /// Teams that stay connected by radio, directly or through other teams.
    #[must_use]
    pub fn connected(pilot: PilotMode) -> Self {
        Self {
            connected: true,
            ..Self::new(pilot)
        }
    }
}

impl Steering for Frontier {
    fn reset(&mut self, model: &Model<'_>, _seed: u64) -> Result<(), OutOfMemory> {
        let uavs = model.uav_count();
        let count = (uavs / model.config().quorum as usize).max(1);
        self.teams.clear();
        for team in 0..count {
            let team = Team {
                uavs: team * uavs / count..(team + 1) * uavs / count,
                target: None,
                looked_at: filled(None, model.config().cell_count())?,
            };
            push(&mut self.teams, team)?;
        }
        self.near = Near {
            targets: filled(Cell::default(), count)?,
            leads: filled((0, 0), count)?,
            cells: filled(Cell::default(), count)?,
            order: filled(0, count)?,
        };
        Ok(())
    }

    fn steer(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory> {
        for index in 0..self.teams.len() {
            let Some(lead) = self.teams[index].lead(state) else {
                self.teams[index].target = None;
                continue;
            };
            self.teams[index].look(model, state, lead);
            let others = &mut self.near.targets;
            others.clear();
            let apart = self.teams.iter().enumerate();
            others.extend(
                apart
                    .filter(|(other, _)| *other != index)
                    .filter_map(|(_, team)| team.target),
            );
            let reach = self.connected.then(|| Reach::of(model, self.pilot));
            let team = &mut self.teams[index];
            if team.arrived(model, state.t()) {
                let here = state.cell(lead);
                team.target = Some(team.choose(model, here, others, reach.as_ref(), state.t()));
            }
            let target = team.target.unwrap_or(state.cell(lead));
            for uav in team.uavs.clone() {
                motions[uav] = toward(state.cell(uav), target);
            }
        }
        if self.connected {
            self.stay_connected(model, state, motions);
        }
        Ok(())
    }
}

impl Team {
    /// Returns the lead: the first UAV of the team that can fly.
    fn lead(&self, state: &StateRef<'_>) -> Option<usize> {
        self.uavs.clone().find(|&uav| can_fly(state, uav))
    }

    /// Updates the searched cells by the map of the lead and by the cells around it.
    fn look(&mut self, model: &Model<'_>, state: &StateRef<'_>, lead: usize) {
        let config = model.config();
        let radius = config.search_map_radius_m / config.cell_size_m;
        let here = state.cell(lead);
        for (index, looked_at) in self.looked_at.iter_mut().enumerate() {
            let believed = if model.map_words() > 0 {
                state.searched(lead, index)
            } else {
                state.visited(index)
            };
            let cell = cell_of(model, index);
            let (dx, dy) = (cell.x.abs_diff(here.x), cell.y.abs_diff(here.y));
            let near = f64::from(dx * dx + dy * dy) <= radius * radius;
            if near || (believed && looked_at.is_none()) {
                *looked_at = Some(state.t());
            }
        }
    }

    /// Returns whether the team needs a new target: it has none, or the present one has been
    /// searched in this step.
    fn arrived(&self, model: &Model<'_>, now: u32) -> bool {
        self.target.is_none_or(|cell| {
            let index = (cell.y * model.config().grid_width + cell.x) as usize;
            self.looked_at[index] == Some(now)
        })
    }

    /// Returns the cell of the highest worth.
    fn choose(
        &self,
        model: &Model<'_>,
        here: Cell,
        others: &[Cell],
        reach: Option<&Reach<'_>>,
        now: u32,
    ) -> Cell {
        let apart_cells = if reach.is_some() {
            RELAYS_APART_CELLS
        } else {
            APART_CELLS
        };
        let in_touch = |cell: Cell| {
            reach.is_none_or(|reach| {
                others.is_empty() || others.iter().any(|&other| reach.hears(other, cell))
            })
        };
        let worth = |index: usize| {
            let cell = cell_of(model, index);
            let age = match self.looked_at[index] {
                Some(at) => i64::from(now - at),
                None => UNSEARCHED,
            };
            let crowded = others
                .iter()
                .any(|other| other.manhattan(cell) < apart_cells);
            age - STEPS_PER_CELL * i64::from(here.manhattan(cell))
                - if crowded { CROWDED } else { 0 }
                - if in_touch(cell) { 0 } else { OUT_OF_TOUCH }
        };
        let mut best = 0;
        for index in 1..self.looked_at.len() {
            if worth(index) > worth(best) {
                best = index;
            }
        }
        cell_of(model, best)
    }
}

impl Frontier {
    /// Cancels moves, team by team, that would disconnect the graph of the leads. If that stops all
    /// teams, they fly to the target of the first team together.
    fn stay_connected(&mut self, model: &Model<'_>, state: &StateRef<'_>, motions: &mut [Motion]) {
        let config = model.config();
        let Near {
            leads,
            cells,
            order,
            ..
        } = &mut self.near;
        leads.clear();
        let teams = self.teams.iter().enumerate();
        leads.extend(teams.filter_map(|(team, of)| of.lead(state).map(|lead| (team, lead))));
        let reach = Reach::of(model, self.pilot);
        // Teams before `index` have moved; those after it are in their present cells.
        cells.clear();
        cells.extend(leads.iter().map(|&(_, lead)| state.cell(lead)));
        let mut somebody_moves = false;
        for (index, &(team, lead)) in leads.iter().enumerate() {
            let before = cells[index];
            cells[index] =
                destination(before, motions[lead], config.grid_width, config.grid_height);
            if reach.in_one_piece(cells, order) {
                somebody_moves |= cells[index] != before;
                continue;
            }
            cells[index] = before;
            for uav in self.teams[team].uavs.clone() {
                motions[uav] = toward(state.cell(uav), before);
            }
        }
        if somebody_moves {
            return;
        }
        let Some(&(first, _)) = leads.first() else {
            return;
        };
        let together = self.teams[first].target;
        for team in &mut self.teams {
            team.target = together;
            for uav in team.uavs.clone() {
                if let Some(target) = together {
                    motions[uav] = toward(state.cell(uav), target);
                }
            }
        }
    }
}

/// The radio links between cells while UAVs sense at the pilot density of the policy.
struct Reach<'m> {
    model: &'m Model<'m>,
    density: f64,
}

impl<'m> Reach<'m> {
    fn of(model: &'m Model<'m>, pilot: PilotMode) -> Self {
        Self {
            model,
            density: pilot.sensing_density(model),
        }
    }

    fn hears(&self, a: Cell, b: Cell) -> bool {
        let (dx, dy) = (a.x.abs_diff(b.x), a.y.abs_diff(b.y));
        let throughput = self.model.link_throughput(dx, dy, self.density);
        throughput >= self.model.config().link_throughput_min
    }

    /// Returns whether the graph of links connects all cells.
    fn in_one_piece(&self, cells: &[Cell], order: &mut [usize]) -> bool {
        // The cells reached so far come first in the order.
        let order = &mut order[..cells.len()];
        for (index, place) in order.iter_mut().enumerate() {
            *place = index;
        }
        let (mut next, mut reached) = (0, 1);
        while next < reached {
            let from = cells[order[next]];
            next += 1;
            let first = reached;
            for other in first..order.len() {
                if self.hears(from, cells[order[other]]) {
                    order.swap(reached, other);
                    reached += 1;
                }
            }
        }
        reached >= order.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Policy;
    use crate::baselines::BaselineKind;
    use jcas_core::{Config, Preset, Sim};

    /// Runs one search. Returns in how many steps the fleet was disconnected, and how many steps it
    /// took.
    fn fly(kind: BaselineKind, seed: u64) -> (usize, u32) {
        let config = Config {
            uav_count: 12,
            hotspot_count: 7,
            ..Config::preset(Preset::Search)
        };
        let model = Model::new(config).unwrap();
        let mut policy = kind.build(&model, PilotMode::Max).unwrap();
        let mut sim = Sim::new(&model);
        sim.reset(seed);
        policy.reset(&model, seed);
        let mut actions = vec![0.0; model.action_len()];
        let mut apart = 0;
        while !sim.state().terminated() && !sim.state().truncated() {
            policy.act(&model, &sim.state(), &mut actions);
            sim.step(&actions).unwrap();
            let cells: Vec<Cell> = (0..12).map(|i| sim.state().cell(i)).collect();
            let reach = Reach::of(&model, PilotMode::Max);
            apart += usize::from(!reach.in_one_piece(&cells, &mut [0; 12]));
        }
        (apart, sim.state().t())
    }

    #[test]
    fn relays_stay_in_touch_and_others_do_not() {
        let (mut apart, mut steps) = ([0, 0], 0);
        for seed in 0..5 {
            apart[0] += fly(BaselineKind::Relay, seed).0;
            apart[1] += fly(BaselineKind::Frontier, seed).0;
            steps += fly(BaselineKind::Relay, seed).1;
        }
        assert_eq!(apart[0], 0, "in {steps} steps");
        assert!(apart[1] > 0);
    }

    #[test]
    fn the_nearest_unsearched_cell_apart_from_others_is_chosen() {
        let model = Model::new(Config::preset(Preset::Search)).unwrap();
        let mut team = Team {
            uavs: 0..3,
            target: None,
            looked_at: vec![Some(4); 144],
        };
        team.looked_at[12 * 2 + 3] = None;
        team.looked_at[12 * 9 + 9] = None;
        let near = Cell { x: 3, y: 2 };
        let far = Cell { x: 9, y: 9 };
        let here = Cell { x: 2, y: 2 };
        assert_eq!(team.choose(&model, here, &[], None, 5), near);
        assert_eq!(
            team.choose(&model, here, &[Cell { x: 3, y: 3 }], None, 5),
            far
        );
        // All cells are searched: the oldest one is chosen, unless it is too far.
        team.looked_at = vec![Some(90); 144];
        team.looked_at[12 * 9 + 9] = Some(1);
        assert_eq!(team.choose(&model, here, &[], None, 95), far);
    }
}
