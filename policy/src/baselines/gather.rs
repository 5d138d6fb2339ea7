//! What a fleet does once every hotspot is confirmed: meet, so that all learn of all.

use jcas_core::motion::toward;
use jcas_core::{Cell, Model, Motion, StateRef};

use super::steering::can_fly;

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
/// differences, so the centre sought is that of the bounding box. It need not be a cell; of the cells
/// around it the best is taken, the one with the least total distance among equals.
fn manhattan_centre(model: &Model<'_>, state: &StateRef<'_>) -> Cell {
    let any_flies = (0..model.uav_count()).any(|uav| can_fly(state, uav));
    let cells = || {
        (0..model.uav_count())
            .filter(|&uav| !state.grounded(uav) || !any_flies)
            .map(|uav| state.cell(uav))
    };
    let middle = |of: fn(i64, i64) -> i64| {
        let along = cells().map(|cell| of(i64::from(cell.x), i64::from(cell.y)));
        let (low, high) = along.fold((i64::MAX, i64::MIN), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        (low + high).div_euclid(2)
    };
    let (u, v) = (middle(|x, y| x + y), middle(|x, y| x - y));
    let config = model.config();
    let near = |value: i64, size: u32| {
        (value - 1..=value + 1).map(move |value| value.clamp(0, i64::from(size) - 1) as u32)
    };
    near((u + v).div_euclid(2), config.grid_width)
        .flat_map(|x| near((u - v).div_euclid(2), config.grid_height).map(move |y| Cell { x, y }))
        .min_by_key(|&centre| {
            let distances = cells().map(|cell| u64::from(cell.manhattan(centre)));
            distances.fold((0, 0), |(most, sum), distance| {
                (distance.max(most), sum + distance)
            })
        })
        .unwrap_or_default()
}
