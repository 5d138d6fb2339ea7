//! `squads`: `teams` within each radio component, by what its members know.

use jcas_core::motion::toward;
use jcas_core::{Cell, Model, Motion, StateRef};

use super::memory::{OutOfMemory, collect, filled, push};
use super::pilot::PilotMode;
use super::steering::{Steering, can_fly};
use super::teams::{Effort, divide, load_target, save_target};
use crate::geometry::meeting_cell;
use crate::memory::save_index;
use crate::{MemoryError, MemoryReader};

/// The policy `squads`, in which each radio component divides its own members and the hotspots.
///
/// A component plans by the cells of its members and the confirmations that they know, which a real
/// fleet would have. Its members keep the plan, in touch or not, until one learns of a confirmation
/// or meets a UAV with another plan. Teams that a component is out of touch with keep the hotspots
/// that their common plan gave them, until it has no others. Two components can choose one hotspot
/// if they never made a plan together. A component that knows all confirmations flies to the middle
/// of the hotspots, where it meets the others.
///
/// Teams are formed as those of [`Teams`](super::Teams). But their routes are improved, and the
/// division is taken whose expected time is least, with random waits for a quorum.
#[derive(Clone, Debug)]
pub struct Squads {
    pilot: PilotMode,
    plans: Vec<SquadPlan>,
    /// The plan of each UAV that flies.
    plan_of_uav: Vec<Option<usize>>,
}

/// A plan that a radio component made. A team goes by the index of one of its members.
#[derive(Clone, Debug)]
struct SquadPlan {
    /// The hotspots that the members knew to be confirmed.
    known: Vec<bool>,
    /// Where each member flies to. Other UAVs have no target.
    target_of_uav: Vec<Option<Cell>>,
    /// The team of each UAV of the fleet, if the plan has it in one.
    team_of_uav: Vec<Option<usize>>,
    /// The team that visits each hotspot, if any.
    team_of_hotspot: Vec<Option<usize>>,
}

impl SquadPlan {
    /// A plan without targets and teams.
    fn new(uavs: usize, known: Vec<bool>) -> Result<Self, OutOfMemory> {
        Ok(Self {
            target_of_uav: filled(None, uavs)?,
            team_of_uav: filled(None, uavs)?,
            team_of_hotspot: filled(None, known.len())?,
            known,
        })
    }

    fn save(&self, write: &mut dyn FnMut(u64)) {
        self.known.iter().for_each(|&known| write(u64::from(known)));
        self.target_of_uav
            .iter()
            .for_each(|&target| save_target(write, target));
        let teams = self.team_of_uav.iter().chain(&self.team_of_hotspot);
        teams.for_each(|&team| save_index(write, team));
    }

    fn load(model: &Model<'_>, read: &mut MemoryReader<'_>) -> Result<Self, MemoryError> {
        let uavs = model.uav_count();
        let mut plan = Self::new(uavs, filled(false, model.hotspot_count())?)?;
        for known in &mut plan.known {
            *known = read.flag()?;
        }
        for target in &mut plan.target_of_uav {
            *target = load_target(model, read)?;
        }
        for team in plan.team_of_uav.iter_mut().chain(&mut plan.team_of_hotspot) {
            *team = read.optional_index(uavs)?;
        }
        Ok(plan)
    }

    /// Takes over the hotspots of teams in an earlier plan that none of these members is in.
    fn leave_to_others(&mut self, before: &Self, members: &[usize]) {
        let here = |(uav, _): (usize, _)| members.binary_search(&uav).is_ok();
        for (hotspot, &team) in before.team_of_hotspot.iter().enumerate() {
            let Some(team) = team else { continue };
            let in_team = |&(_, other): &(usize, &Option<usize>)| *other == Some(team);
            let uavs = || before.team_of_uav.iter().enumerate().filter(in_team);
            if !self.known[hotspot] && !uavs().any(here) {
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
            plans: Vec::new(),
            plan_of_uav: Vec::new(),
        }
    }

    /// Returns the plan that all members have, if it was made by the hotspots that they know.
    fn common_plan(&self, members: &[usize], known: &[bool]) -> Option<usize> {
        let plan = self.plan_of_uav[*members.first()?]?;
        let common = members
            .iter()
            .all(|&uav| self.plan_of_uav[uav] == Some(plan));
        (common && self.plans[plan].known == known).then_some(plan)
    }

    /// Plans for a component, whose members know these hotspots.
    fn plan(
        &self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        members: &[usize],
        known: Vec<bool>,
    ) -> Result<SquadPlan, OutOfMemory> {
        let mut squad = SquadPlan::new(model.uav_count(), known)?;
        if squad.known.iter().all(|known| *known) {
            let hotspots = (0..model.hotspot_count()).map(|hotspot| state.hotspot_cell(hotspot));
            let config = model.config();
            let centre = meeting_cell(hotspots, config.grid_width, config.grid_height);
            for &uav in members {
                squad.target_of_uav[uav] = Some(centre);
            }
            return Ok(squad);
        }
        for (index, before) in self.plans.iter().enumerate() {
            if members
                .iter()
                .any(|&uav| self.plan_of_uav[uav] == Some(index))
            {
                squad.leave_to_others(before, members);
            }
        }
        let own = squad.own()?;
        let left = collect(own.iter().map(|&hotspot| state.hotspot_cell(hotspot)))?;
        let cells = collect(members.iter().map(|&uav| state.cell(uav)))?;
        let plan = divide(model, self.pilot, &cells, &left, Effort::Thorough)?;
        let first = |team: usize| {
            let place = plan.team_of_uav.iter().position(|&other| other == team);
            place.map(|place| members[place])
        };
        let names = collect((0..plan.routes.len()).map(first))?;
        for (route, &name) in plan.routes.iter().zip(&names) {
            for &hotspot in route {
                squad.team_of_hotspot[own[hotspot]] = name;
            }
        }
        let teams = plan.team_of_uav.iter().zip(plan.targets(&left));
        for (&uav, (&team, target)) in members.iter().zip(teams) {
            squad.team_of_uav[uav] = names[team];
            squad.target_of_uav[uav] = Some(target);
        }
        Ok(squad)
    }

    /// Removes the plans that no UAV has.
    fn forget_old_plans(&mut self) {
        for index in (0..self.plans.len()).rev() {
            if !self.plan_of_uav.contains(&Some(index)) {
                self.plans.remove(index);
                for plan in self.plan_of_uav.iter_mut().flatten() {
                    *plan -= usize::from(*plan > index);
                }
            }
        }
    }
}

impl Steering for Squads {
    fn reset(&mut self, model: &Model<'_>) -> Result<(), OutOfMemory> {
        self.plans.clear();
        self.plan_of_uav = filled(None, model.uav_count())?;
        Ok(())
    }

    fn save(&self, write: &mut dyn FnMut(u64)) {
        write(self.plans.len() as u64);
        self.plans.iter().for_each(|plan| plan.save(write));
        self.plan_of_uav
            .iter()
            .for_each(|&plan| save_index(write, plan));
    }

    fn load(&mut self, model: &Model<'_>, read: &mut MemoryReader<'_>) -> Result<(), MemoryError> {
        for _ in 0..read.count()? {
            push(&mut self.plans, SquadPlan::load(model, read)?)?;
        }
        for plan in &mut self.plan_of_uav {
            *plan = read.optional_index(self.plans.len())?;
        }
        Ok(())
    }

    fn steer(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory> {
        let mut met = filled(false, model.uav_count())?;
        for first in 0..model.uav_count() {
            if !can_fly(state, first) {
                self.plan_of_uav[first] = None;
                continue;
            }
            if met[first] {
                continue;
            }
            let members = component(state, first, &mut met)?;
            let known = (0..model.hotspot_count()).map(|hotspot| state.knows(first, hotspot));
            let known = collect(known)?;
            let plan = match self.common_plan(&members, &known) {
                Some(plan) => plan,
                None => {
                    let plan = self.plan(model, state, &members, known)?;
                    push(&mut self.plans, plan)?;
                    self.plans.len() - 1
                }
            };
            for uav in members {
                self.plan_of_uav[uav] = Some(plan);
                if let Some(target) = self.plans[plan].target_of_uav[uav] {
                    motions[uav] = toward(state.cell(uav), target);
                }
            }
        }
        self.forget_old_plans();
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
    let mut visited = 0;
    while let Some(&uav) = members.get(visited) {
        for other in state.neighbours(uav) {
            if !met[other] && can_fly(state, other) {
                met[other] = true;
                push(&mut members, other)?;
            }
        }
        visited += 1;
    }
    members.sort_unstable();
    Ok(members)
}

#[cfg(test)]
mod tests {
    use jcas_core::{Config, MotionMap, Preset, Sim};

    use super::*;
    use crate::BaselineKind;
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
        let first_actions = |others: Cell| {
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
        let (near, far) = (
            first_actions(Cell { x: 15, y: 15 }),
            first_actions(Cell { x: 12, y: 12 }),
        );
        assert_eq!(near[..8], far[..8]);
        let motion = |actions: &[f32; 16], uav: usize| actions[2 * uav];
        assert_eq!(motion(&near, 0), Motion::Right.to_action(MotionMap::Udlrs));
        assert_eq!(motion(&near, 4), Motion::Left.to_action(MotionMap::Udlrs));
        assert_ne!(motion(&near, 4), motion(&far, 4));
    }

    // Teams 0 and 3 divided three hotspots. The second confirmed one of its two, and team 0 has not
    // received that.
    #[test]
    fn hotspots_of_a_team_out_of_touch_are_left_to_it() {
        let mut before = SquadPlan::new(6, vec![false; 3]).unwrap();
        before.team_of_uav = [0, 0, 0, 3, 3, 3].map(Some).to_vec();
        before.team_of_hotspot = [0, 3, 3].map(Some).to_vec();
        let own = |members: &[usize], known: [bool; 3]| {
            let mut after = SquadPlan::new(6, known.to_vec()).unwrap();
            after.leave_to_others(&before, members);
            after.own().unwrap()
        };
        assert_eq!(own(&[0, 1, 2], [false; 3]), [0]);
        assert_eq!(own(&[3, 4, 5], [false, true, false]), [2]);
        // One UAV of the other team is here.
        assert_eq!(own(&[0, 1, 2, 3], [false; 3]), [0, 1, 2]);
        // The team has no others.
        assert_eq!(own(&[0, 1, 2], [true, false, false]), [1, 2]);
    }

    // UAVs 0 to 3 made one plan and UAVs 4 and 5 another, and nobody knows of a confirmation.
    #[test]
    fn a_plan_is_kept_without_news_and_strangers() {
        let mut policy = Squads::new(PilotMode::Adaptive);
        policy.plans = vec![SquadPlan::new(6, vec![false; 2]).unwrap(); 2];
        policy.plan_of_uav = [0, 0, 0, 0, 1, 1].map(Some).to_vec();
        let common = |members: &[usize], known: bool| policy.common_plan(members, &[known, false]);
        assert_eq!(common(&[0, 1, 2, 3], false), Some(0));
        assert_eq!(common(&[1, 3], false), Some(0));
        assert_eq!(common(&[4, 5], false), Some(1));
        assert_eq!(common(&[1, 3], true), None);
        assert_eq!(common(&[3, 4], false), None);
    }

    #[test]
    fn plans_of_nobody_are_forgotten() {
        let mut policy = Squads::new(PilotMode::Adaptive);
        policy.plans = vec![SquadPlan::new(4, vec![false; 4]).unwrap(); 4];
        for (index, plan) in policy.plans.iter_mut().enumerate() {
            plan.known[index] = true;
        }
        policy.plan_of_uav = vec![Some(3), None, Some(1), Some(3)];
        policy.forget_old_plans();
        assert_eq!(policy.plans.len(), 2);
        let known = |uav: usize| policy.plan_of_uav[uav].map(|plan| &policy.plans[plan].known);
        assert!(known(0).unwrap()[3] && known(3).unwrap()[3] && known(2).unwrap()[1]);
        assert_eq!(known(1), None);
    }

    // Two teams went to and fro between two cells in these episodes. In the first they planned anew
    // in each step, and in the second whenever they met or parted. In the third a team was torn.
    #[test]
    fn a_squad_does_not_fly_in_circles() {
        for (hotspot_count, seed) in [(7, 804), (5, 96), (11, 4546)] {
            let config = Config {
                uav_count: 20,
                hotspot_count,
                ..Config::preset(Preset::Mission)
            };
            let model = Model::new(config).unwrap();
            let mut sim = Sim::new(&model);
            sim.reset(seed);
            let mut policy = BaselineKind::Squads
                .build(&model, PilotMode::Adaptive)
                .unwrap();
            policy.reset(&model, seed);
            let mut actions = [0.0; 40];
            let ended = (0..100).any(|_| {
                policy.act(&model, &sim.state(), &mut actions);
                sim.step(&actions).unwrap().terminated
            });
            assert!(ended, "{hotspot_count} hotspots, seed {seed}");
        }
    }
}
