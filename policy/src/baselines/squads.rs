//! `squads`: `teams` within each radio component, by what its members know.

use jcas_core::motion::toward;
use jcas_core::{Cell, Model, Motion, StateRef};

use super::gather::manhattan_centre;
use super::memory::{OutOfMemory, collect, filled, push};
use super::pilot::PilotMode;
use super::steering::{Steering, can_fly};
use super::teams::targets;

/// The policy `squads`, in which each radio component divides its own members as
/// [`Teams`](super::Teams) divides the fleet.
///
/// A component plans by the cells of its members and the confirmations that they know, which a real
/// fleet would have. It keeps the plan while its members and their knowledge stay the same. Two
/// components can choose one hotspot. A component that knows all confirmations flies to the middle
/// of the hotspots, where it meets the others.
#[derive(Clone, Debug)]
pub struct Squads {
    pilot: PilotMode,
    /// The components of the step before.
    squads: Vec<Squad>,
}

/// A radio component with its plan.
#[derive(Clone, Debug)]
struct Squad {
    /// The members that can fly, in ascending order.
    members: Vec<usize>,
    /// The hotspots that they knew to be confirmed.
    known: Vec<bool>,
    /// Where each member flies to.
    targets: Vec<Cell>,
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

    /// Returns where each member of a component flies to, whose members know these hotspots.
    fn plan(
        &self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        members: &[usize],
        known: &[bool],
    ) -> Result<Vec<Cell>, OutOfMemory> {
        let hotspots = || (0..model.hotspot_count()).map(|hotspot| state.hotspot_cell(hotspot));
        let unknown = hotspots().zip(known).filter(|(_, known)| !**known);
        let left = collect(unknown.map(|(cell, _)| cell))?;
        if left.is_empty() {
            return filled(manhattan_centre(model, hotspots), members.len());
        }
        let cells = collect(members.iter().map(|&uav| state.cell(uav)))?;
        targets(model, self.pilot, &cells, &left)
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
        let mut squads = Vec::new();
        let mut met = filled(false, model.uav_count())?;
        for first in 0..model.uav_count() {
            if met[first] || !can_fly(state, first) {
                continue;
            }
            let members = component(state, first, &mut met)?;
            let known = (0..model.hotspot_count()).map(|hotspot| state.knows(first, hotspot));
            let known = collect(known)?;
            let same = |squad: &&Squad| squad.members == members && squad.known == known;
            let targets = match self.squads.iter().find(same) {
                Some(squad) => collect(squad.targets.iter().copied())?,
                None => self.plan(model, state, &members, &known)?,
            };
            for (&uav, &target) in members.iter().zip(&targets) {
                motions[uav] = toward(state.cell(uav), target);
            }
            let squad = Squad {
                members,
                known,
                targets,
            };
            push(&mut squads, squad)?;
        }
        self.squads = squads;
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
