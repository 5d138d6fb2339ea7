//! `squads`: `teams` within each radio component, by what its members know.

use jcas_core::motion::toward;
use jcas_core::{Cell, Model, Motion, StateRef};

use super::gather::manhattan_centre;
use super::memory::{OutOfMemory, collect, filled, push};
use super::pilot::PilotMode;
use super::steering::{Steering, can_fly};
use super::teams::{Effort, divide};

/// The policy `squads`, in which each radio component divides its own members and the hotspots.
///
/// A component plans by the cells of its members and the confirmations that they know, which a real
/// fleet would have. It plans anew when it learns of a confirmation, meets others, or loses a part
/// of a team. Teams that it is out of touch with keep the hotspots that the last common plan gave
/// them, until it has no others. Two components can choose one hotspot if they never made a plan
/// together. A component that knows all confirmations flies to the middle of the hotspots, where it
/// meets the others.
///
/// Teams are formed as those of [`Teams`](super::Teams). But their routes are improved, and the
/// division is taken whose expected time is least, with random waits for a quorum.
#[derive(Clone, Debug)]
pub struct Squads {
    pilot: PilotMode,
    /// The components of the step before.
    squads: Vec<Squad>,
}

/// A radio component with its plan. A team goes by the index of one of its members.
#[derive(Clone, Debug)]
struct Squad {
    /// The members that can fly, in ascending order.
    members: Vec<usize>,
    /// The hotspots that they knew to be confirmed.
    known: Vec<bool>,
    /// Where each member flies to.
    targets: Vec<Cell>,
    /// The team of each UAV of the fleet, if the plan has it in one.
    team_of_uav: Vec<Option<usize>>,
    /// The team that visits each hotspot, if any.
    team_of_hotspot: Vec<Option<usize>>,
}

impl Squad {
    /// A component without a plan, whose members stay together.
    fn new(
        model: &Model<'_>,
        members: Vec<usize>,
        known: Vec<bool>,
        targets: Vec<Cell>,
    ) -> Result<Self, OutOfMemory> {
        Ok(Self {
            members,
            known,
            targets,
            team_of_uav: filled(None, model.uav_count())?,
            team_of_hotspot: filled(None, model.hotspot_count())?,
        })
    }

    /// Returns whether these members go on by the plan of the squad. It has to be made by the
    /// hotspots that they know, and they have to be whole teams.
    fn goes_on(&self, members: &[usize], known: &[bool]) -> bool {
        if self.members == members || self.known != known {
            return self.known == known;
        }
        let here = |uav: usize| members.binary_search(&uav).is_ok();
        let whole = |team: Option<usize>| {
            let mates = (0..self.team_of_uav.len()).filter(|&uav| self.team_of_uav[uav] == team);
            team.is_none() || mates.into_iter().all(here)
        };
        members
            .iter()
            .all(|uav| self.members.binary_search(uav).is_ok() && whole(self.team_of_uav[*uav]))
    }

    /// Returns the squad of some members that go on by the plan.
    fn part(&self, members: Vec<usize>) -> Result<Self, OutOfMemory> {
        let targets = self.members.iter().zip(&self.targets);
        let here = targets.filter(|(uav, _)| members.binary_search(uav).is_ok());
        Ok(Self {
            targets: collect(here.map(|(_, &target)| target))?,
            members,
            known: collect(self.known.iter().copied())?,
            team_of_uav: collect(self.team_of_uav.iter().copied())?,
            team_of_hotspot: collect(self.team_of_hotspot.iter().copied())?,
        })
    }

    /// Takes over the hotspots of teams that another squad, with members of this one, knew of. None
    /// of these teams has a member here.
    fn leave_to_others(&mut self, before: &Self) {
        let here = |uav: &usize| self.members.binary_search(uav).is_ok();
        if !before.members.iter().any(here) {
            return;
        }
        for (hotspot, &team) in before.team_of_hotspot.iter().enumerate() {
            let Some(team) = team else { continue };
            let in_team = |&(_, other): &(usize, &Option<usize>)| *other == Some(team);
            let uavs = || before.team_of_uav.iter().enumerate().filter(in_team);
            if !self.known[hotspot] && !uavs().any(|(uav, _)| here(&uav)) {
                self.team_of_hotspot[hotspot] = Some(team);
                for (uav, _) in uavs() {
                    self.team_of_uav[uav] = Some(team);
                }
            }
        }
    }

    /// Returns the hotspots that the members visit. These are the open ones that are left to no
    /// other team, or else all open ones.
    fn own(&mut self) -> Result<Vec<usize>, OutOfMemory> {
        let open = || (0..self.known.len()).filter(|&hotspot| !self.known[hotspot]);
        let own = collect(open().filter(|&hotspot| self.team_of_hotspot[hotspot].is_none()))?;
        if !own.is_empty() {
            return Ok(own);
        }
        let open = collect(open())?;
        self.team_of_hotspot.fill(None);
        Ok(open)
    }
}

impl Squads {
    /// Builds the policy for the pilot density of the squads, which decides their size.
    #[must_use]
    pub const fn new(pilot: PilotMode) -> Self {
        Self {
            pilot,
            squads: Vec::new(),
        }
    }

    /// Plans for a component, whose members know these hotspots.
    fn plan(
        &self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        members: Vec<usize>,
        known: Vec<bool>,
        before: &[Squad],
    ) -> Result<Squad, OutOfMemory> {
        let hotspots = || (0..model.hotspot_count()).map(|hotspot| state.hotspot_cell(hotspot));
        if known.iter().all(|known| *known) {
            let targets = filled(manhattan_centre(model, hotspots), members.len())?;
            return Squad::new(model, members, known, targets);
        }
        let mut squad = Squad::new(model, members, known, Vec::new())?;
        for other in before {
            squad.leave_to_others(other);
        }
        let own = squad.own()?;
        let left = collect(own.iter().map(|&hotspot| state.hotspot_cell(hotspot)))?;
        let cells = collect(squad.members.iter().map(|&uav| state.cell(uav)))?;
        let plan = divide(model, self.pilot, &cells, &left, Effort::Thorough)?;
        squad.targets = collect(plan.targets(&left))?;
        let first = |team: usize| {
            let place = plan.team_of_uav.iter().position(|&other| other == team);
            place.map(|place| squad.members[place])
        };
        for (team, route) in plan.routes.iter().enumerate() {
            for &hotspot in route {
                squad.team_of_hotspot[own[hotspot]] = first(team);
            }
        }
        for (&uav, &team) in squad.members.iter().zip(&plan.team_of_uav) {
            squad.team_of_uav[uav] = first(team);
        }
        Ok(squad)
    }
}

impl Steering for Squads {
    fn reset(&mut self, _model: &Model<'_>, _seed: u64) -> Result<(), OutOfMemory> {
        self.squads.clear();
        Ok(())
    }

    fn steer(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory> {
        let before = std::mem::take(&mut self.squads);
        let mut met = filled(false, model.uav_count())?;
        for first in 0..model.uav_count() {
            if met[first] || !can_fly(state, first) {
                continue;
            }
            let members = component(state, first, &mut met)?;
            let known = (0..model.hotspot_count()).map(|hotspot| state.knows(first, hotspot));
            let known = collect(known)?;
            let squad = match before.iter().find(|squad| squad.goes_on(&members, &known)) {
                Some(squad) => squad.part(members)?,
                None => self.plan(model, state, members, known, &before)?,
            };
            for (&uav, &target) in squad.members.iter().zip(&squad.targets) {
                motions[uav] = toward(state.cell(uav), target);
            }
            push(&mut self.squads, squad)?;
        }
        Ok(())
    }
}

/// Returns the UAVs that can fly in the radio component of `first`, in ascending order, and marks
/// them in `met`.
fn component(
    state: &StateRef<'_>,
    first: usize,
    met: &mut [bool],
) -> Result<Vec<usize>, OutOfMemory> {
    let mut members = filled(first, 1)?;
    met[first] = true;
    let mut heard = 0;
    while let Some(&uav) = members.get(heard) {
        for other in state.neighbours(uav) {
            if !met[other] && can_fly(state, other) {
                met[other] = true;
                push(&mut members, other)?;
            }
        }
        heard += 1;
    }
    members.sort_unstable();
    Ok(members)
}

#[cfg(test)]
mod tests {
    use jcas_core::{Config, Preset, Sim};

    use super::super::BaselineKind;
    use super::*;
    use crate::Policy;

    // Two groups at opposite corners are out of each other's reach. Each flies to the hotspot
    // beside it, and neither moves otherwise when the other group is elsewhere.
    #[test]
    fn a_squad_does_not_read_what_is_out_of_reach() {
        let config = Config {
            uav_count: 8,
            hotspot_count: 2,
            grid_width: 16,
            grid_height: 16,
            ..Config::preset(Preset::Mission)
        };
        let model = Model::new(config).unwrap();
        let flown = |others: Cell| {
            let mut sim = Sim::new(&model);
            sim.reset(1);
            sim.set_hotspots(&[Cell { x: 2, y: 0 }, Cell { x: 13, y: 15 }])
                .unwrap();
            let starts: Vec<Cell> = (0..8)
                .map(|uav| if uav < 4 { Cell::default() } else { others })
                .collect();
            sim.set_starts(&starts).unwrap();
            let mut policy = BaselineKind::Squads
                .build(&model, PilotMode::Adaptive)
                .unwrap();
            policy.reset(&model, 1);
            let mut actions = [9.0; 16];
            policy.act(&model, &sim.state(), &mut actions);
            actions
        };
        let (near, far) = (flown(Cell { x: 15, y: 15 }), flown(Cell { x: 12, y: 12 }));
        assert_eq!(near[..8], far[..8]);
        let motion = |actions: &[f32; 16], uav: usize| actions[2 * uav];
        assert_eq!(motion(&near, 0), Motion::Right.to_action());
        assert_eq!(motion(&near, 4), Motion::Left.to_action());
        assert_ne!(motion(&near, 4), motion(&far, 4));
    }

    // Two teams that planned anew in each step went to and fro between two cells in this episode.
    #[test]
    fn a_squad_does_not_fly_in_circles() {
        let config = Config {
            uav_count: 20,
            hotspot_count: 7,
            ..Config::preset(Preset::Mission)
        };
        let model = Model::new(config).unwrap();
        let mut sim = Sim::new(&model);
        sim.reset(804);
        let mut policy = BaselineKind::Squads
            .build(&model, PilotMode::Adaptive)
            .unwrap();
        policy.reset(&model, 804);
        let mut actions = [0.0; 40];
        let ended = (0..100).any(|_| {
            policy.act(&model, &sim.state(), &mut actions);
            sim.step(&actions).unwrap().terminated
        });
        assert!(ended);
    }
}
