//! What a fleet does once every hotspot is confirmed: meet, so that all learn of all.

use jcas_core::motion::toward;
use jcas_core::{Cell, Model, Motion, StateRef};

use super::baseline::can_fly;

/// Sends every UAV toward the meeting point of the fleet.
///
/// The meeting point is the Manhattan centre: the cell from which the farthest UAV is nearest, so that
/// the last pair to meet meets as early as it can. It is found anew in each step; on the way the fleet
/// shrinks to within the range of its links, and the mission ends as soon as the graph connects.
/// A grounded UAV away from a depot can be told nothing any more and does not count; a UAV that returns
/// to its base counts where it is.
pub fn gather(model: &Model<'_>, state: &StateRef<'_>, motions: &mut [Motion]) {
    let meeting_point = manhattan_centre(model, state);
    for (uav, motion) in motions.iter_mut().enumerate() {
        *motion = toward(state.cell(uav), meeting_point);
    }
}

/// In the rotated coordinates u = x + y, v = x - y Manhattan distance is the larger of the two
/// differences, so the centre of the bounding box is the centre sought.
fn manhattan_centre(model: &Model<'_>, state: &StateRef<'_>) -> Cell {
    let (mut u_min, mut u_max) = (i64::MAX, i64::MIN);
    let (mut v_min, mut v_max) = (i64::MAX, i64::MIN);
    let any_flies = (0..model.uav_count()).any(|uav| can_fly(state, uav));
    for uav in 0..model.uav_count() {
        if state.grounded(uav) && any_flies {
            continue;
        }
        let cell = state.cell(uav);
        let (x, y) = (i64::from(cell.x), i64::from(cell.y));
        u_min = u_min.min(x + y);
        u_max = u_max.max(x + y);
        v_min = v_min.min(x - y);
        v_max = v_max.max(x - y);
    }
    let (u, v) = ((u_min + u_max).div_euclid(2), (v_min + v_max).div_euclid(2));
    let onto = |value: i64, size: u32| value.clamp(0, i64::from(size) - 1) as u32;
    Cell {
        x: onto((u + v).div_euclid(2), model.config().grid_width),
        y: onto((u - v).div_euclid(2), model.config().grid_height),
    }
}
