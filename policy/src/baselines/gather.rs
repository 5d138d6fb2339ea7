//! The end of an episode: the fleet gathers once every hotspot is confirmed, to share this
//! knowledge.

use jcas_core::motion::toward;
use jcas_core::{Model, Motion, StateRef};

use super::steering::can_fly;
use crate::geometry::meeting_cell;

/// Sends every UAV toward the meeting point of the fleet.
///
/// The meeting point is the Manhattan centre: the cell with the least distance to the farthest UAV.
/// The last two UAVs thus meet as early as they can. It is computed anew in each step. The fleet
/// contracts until its links connect it, and the episode ends then. A grounded UAV away from a
/// depot can no longer be informed and does not count. A UAV that returns to its base counts in its
/// present cell.
pub fn gather(model: &Model<'_>, state: &StateRef<'_>, motions: &mut [Motion]) {
    let any_flies = (0..model.uav_count()).any(|uav| can_fly(state, uav));
    let cells = (0..model.uav_count())
        .filter(|&uav| !state.grounded(uav) || !any_flies)
        .map(|uav| state.cell(uav));
    let config = model.config();
    let meeting_point = meeting_cell(cells, config.grid_width, config.grid_height);
    for (uav, motion) in motions.iter_mut().enumerate() {
        *motion = toward(state.cell(uav), meeting_point);
    }
}
