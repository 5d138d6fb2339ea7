//! `swarm`: the whole fleet flies to the unconfirmed hotspot nearest to its centroid.

use jcas_core::motion::toward;
use jcas_core::{Cell, Model, Motion, StateRef};

use super::memory::OutOfMemory;
use super::steering::{Steering, can_fly};

/// The policy `swarm`, in which all UAVs fly as one flock. With the quorum in one step, numbers
/// count: ten UAVs confirm a hotspot in about five steps, and five UAVs in thirty. Flying apart
/// thus rarely pays with few UAVs.
#[derive(Clone, Debug, Default)]
pub struct Swarm;

impl Steering for Swarm {
    fn steer(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory> {
        let target = nearest_to_centroid(model, state);
        for (uav, motion) in motions.iter_mut().enumerate() {
            *motion = target.map_or(Motion::Stay, |cell| toward(state.cell(uav), cell));
        }
        Ok(())
    }
}

/// Returns the unconfirmed hotspot at the least Manhattan distance from the centroid of the UAVs
/// that can fly. If none can fly, all count. Distances are scaled by the number of UAVs, so that
/// they are exact.
fn nearest_to_centroid(model: &Model<'_>, state: &StateRef<'_>) -> Option<Cell> {
    let any_flies = (0..model.uav_count()).any(|uav| can_fly(state, uav));
    let (mut count, mut sum_x, mut sum_y) = (0u64, 0u64, 0u64);
    for uav in 0..model.uav_count() {
        if can_fly(state, uav) || !any_flies {
            let cell = state.cell(uav);
            count += 1;
            sum_x += u64::from(cell.x);
            sum_y += u64::from(cell.y);
        }
    }
    (0..model.hotspot_count())
        .filter(|&hotspot| !state.confirmed(hotspot))
        .map(|hotspot| state.hotspot_cell(hotspot))
        .min_by_key(|cell| {
            (count * u64::from(cell.x)).abs_diff(sum_x)
                + (count * u64::from(cell.y)).abs_diff(sum_y)
        })
}
