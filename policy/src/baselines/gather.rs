//! The end of an episode: the fleet gathers once every hotspot is confirmed, to share this
//! knowledge.

use jcas_core::motion::toward;
use jcas_core::{Cell, Model, Motion, StateRef};

use super::steering::can_fly;

/// Sends every UAV toward the meeting point of the fleet.
///
/// The meeting point is the Manhattan centre: the cell with the least distance to the farthest UAV.
/// The last two UAVs thus meet as early as they can. It is computed anew in each step. The fleet
/// contracts until its links connect it, and the episode ends then. A grounded UAV away from a
/// depot can no longer be informed and does not count. A UAV that returns to its base counts in its
/// present cell.
pub fn gather(model: &Model<'_>, state: &StateRef<'_>, motions: &mut [Motion]) {
    let any_flies = (0..model.uav_count()).any(|uav| can_fly(state, uav));
    let cells = || {
        (0..model.uav_count())
            .filter(|&uav| !state.grounded(uav) || !any_flies)
            .map(|uav| state.cell(uav))
    };
    let meeting_point = manhattan_centre(model, cells);
    for (uav, motion) in motions.iter_mut().enumerate() {
        *motion = toward(state.cell(uav), meeting_point);
    }
}

/// Returns the cell with the least distance to the farthest of some cells.
///
/// In the rotated coordinates u = x + y, v = x - y, Manhattan distance is the larger of the two
/// differences. The centre is therefore that of the bounding box. If it is not a cell, the best
/// cell around it is taken. Among equals that is the one with the least total distance.
pub(super) fn manhattan_centre<I: Iterator<Item = Cell>>(
    model: &Model<'_>,
    cells: impl Fn() -> I,
) -> Cell {
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
