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
/// A component plans anew in each step, by the cells of its members and the confirmations that they
/// know. So it needs no memory, and nothing that a real fleet would not have. Two components can
/// choose one hotspot. A component that knows all confirmations flies to the middle of the
/// hotspots, where it meets the others.
#[derive(Clone, Debug)]
pub struct Squads {
    pilot: PilotMode,
}

impl Squads {
    /// Builds the policy for the pilot density of the squads, which decides their size.
    #[must_use]
    pub const fn new(pilot: PilotMode) -> Self {
        Self { pilot }
    }
}

impl Steering for Squads {
    fn steer(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory> {
        let hotspots = || (0..model.hotspot_count()).map(|hotspot| state.hotspot_cell(hotspot));
        let middle = manhattan_centre(model, hotspots);
        let mut met = filled(false, model.uav_count())?;
        for first in 0..model.uav_count() {
            if met[first] || !can_fly(state, first) {
                continue;
            }
            let members = component(state, first, &mut met)?;
            let cells = collect(members.iter().map(|&uav| state.cell(uav)))?;
            let left = (0..model.hotspot_count()).filter(|&hotspot| !state.knows(first, hotspot));
            let left = collect(left.map(|hotspot| state.hotspot_cell(hotspot)))?;
            let to: Vec<Cell> = if left.is_empty() {
                filled(middle, members.len())?
            } else {
                targets(model, self.pilot, &cells, &left)?
            };
            for ((&uav, &from), to) in members.iter().zip(&cells).zip(to) {
                motions[uav] = toward(from, to);
            }
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
}
