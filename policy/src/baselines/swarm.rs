//! `swarm`: the whole fleet flies to the unconfirmed hotspot nearest to its centroid.

use jcas_core::motion::toward;
use jcas_core::{Cell, Model, Motion, StateRef};

use super::memory::OutOfMemory;
use super::steering::{Steering, can_fly};

/// One flock. A quorum in one step is a matter of numbers: ten UAVs over a hotspot confirm it in about
/// five steps where five need thirty, so that flying apart rarely pays with few UAVs.
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

/// The unconfirmed hotspot at the least Manhattan distance from the centroid of the UAVs that can fly
/// (of all, where none can). Scaled by the number of UAVs, so that all is exact.
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
