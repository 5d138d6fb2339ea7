//! Where a UAV goes: its own motion, or back to a depot.

use crate::config::Cell;
use crate::lanes::{Block, Cells, Lanes};
use crate::model::Model;
use crate::rules::action::Motion;
use crate::state::StateMut;

pub use crate::words::geometry::nearest;

/// The cell after a motion; a move off the grid is a stay.
// Proof: proofs/motion.rs, every_motion_ends_on_the_grid
#[inline(always)]
#[must_use]
pub const fn destination(cell: Cell, motion: Motion, width: u32, height: u32) -> Cell {
    let from = (cell.x as i32, cell.y as i32);
    let (x, y) = moved(from, motion.offset(), width as i32, height as i32);
    Cell {
        x: x as u32,
        y: y as u32,
    }
}

/// (x, y) after an offset, or as it was if that leads off the grid; without a branch.
#[inline(always)]
const fn moved(from: (i32, i32), offset: (i32, i32), width: i32, height: i32) -> (i32, i32) {
    let (x, y) = (from.0 + offset.0, from.1 + offset.1);
    let inside = x >= 0 && x < width && y >= 0 && y < height;
    (
        if inside { x } else { from.0 },
        if inside { y } else { from.1 },
    )
}

/// Moves the UAVs of a block by an offset each, as far as the grid allows.
#[inline(always)]
pub(crate) fn fly<const W: usize>(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    block: Block<W>,
    offsets: &Lanes<(i32, i32), W>,
) {
    let config = model.config();
    let (width, height) = (config.grid_width as i32, config.grid_height as i32);
    let from = block.load(state.cells);
    let cells = Cells::of(&from);
    let mut to = [0; W];
    for lane in 0..W {
        let cell = (cells.x[lane], cells.y[lane]);
        let (x, y) = moved(cell, offsets[lane], width, height);
        to[lane] = x as u64 | (y as u64) << 32;
    }
    block.store(&from, state.previous);
    block.store(&to, state.cells);
}

/// Moves a set of UAVs, by their distance from the first, one cell toward the nearest depot
/// instead.
#[inline(always)]
pub(crate) fn fly_home(model: &Model<'_>, state: &mut StateMut<'_>, first: usize, uavs: u64) {
    let config = model.config();
    let mut rest = uavs;
    while rest != 0 {
        let i = first + rest.trailing_zeros() as usize;
        rest &= rest - 1;
        let from = Cell::from_word(state.previous[i]);
        let motion = toward(from, model.nearest_depot(from).0);
        let to = destination(from, motion, config.grid_width, config.grid_height);
        state.cells[i] = to.to_word();
    }
}

/// The motion that brings a UAV one cell nearer to a target, x before y; stay once there.
// Proof: proofs/motion.rs, returning_nears_the_depot
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
