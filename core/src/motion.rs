//! Where a UAV goes: its own motion, or back to a depot.

use crate::action::Motion;
use crate::config::Cell;

/// The cell after a motion; a move off the grid is a stay.
#[inline(always)]
#[must_use]
pub const fn destination(cell: Cell, motion: Motion, width: u32, height: u32) -> Cell {
    let Cell { x, y } = cell;
    match motion {
        Motion::Up if y + 1 < height => Cell { x, y: y + 1 },
        Motion::Down if y > 0 => Cell { x, y: y - 1 },
        Motion::Left if x > 0 => Cell { x: x - 1, y },
        Motion::Right if x + 1 < width => Cell { x: x + 1, y },
        _ => cell,
    }
}

/// The motion that brings a UAV one cell nearer to a target, x before y; stay once there.
#[inline(always)]
#[must_use]
pub const fn toward(from: Cell, to: Cell) -> Motion {
    if from.x < to.x {
        Motion::Right
    } else if from.x > to.x {
        Motion::Left
    } else if from.y < to.y {
        Motion::Up
    } else if from.y > to.y {
        Motion::Down
    } else {
        Motion::Stay
    }
}

/// Index of the nearest cell by Manhattan distance, and that distance; ties go to the lowest index.
///
/// For an empty list: index 0, distance `u32::MAX`.
#[must_use]
pub fn nearest(from: Cell, cells: &[Cell]) -> (usize, u32) {
    let mut best = (0, u32::MAX);
    for (index, &cell) in cells.iter().enumerate() {
        let distance = from.manhattan(cell);
        if distance < best.1 {
            best = (index, distance);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_motion_from_every_cell_of_small_grids_stays_on_the_grid() {
        for width in 1..=5 {
            for height in 1..=5 {
                for x in 0..width {
                    for y in 0..height {
                        for motion in Motion::ALL {
                            let from = Cell { x, y };
                            let to = destination(from, motion, width, height);
                            assert!(to.x < width && to.y < height);
                            assert!(from.manhattan(to) <= 1);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn x_before_y_and_lowest_index_first() {
        let from = Cell { x: 2, y: 2 };
        assert_eq!(toward(from, Cell { x: 3, y: 3 }), Motion::Right);
        assert_eq!(toward(from, Cell { x: 2, y: 0 }), Motion::Down);
        assert_eq!(toward(from, from), Motion::Stay);
        let depots = [Cell { x: 4, y: 2 }, Cell { x: 0, y: 2 }];
        assert_eq!(nearest(from, &depots), (0, 2));
    }
}
