//! P8 for maps: the disc that a UAV searches adds exactly the cells within its radius, and loses
//! none.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::config::Cell;
use crate::words::geometry::Disc;

/// Cells along a side of the harness's grid: one beside the middle on every side.
const SIDE: u64 = 3;

/// The map of one UAV that searches around its cell. Kani checks any one cell of the map.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
#[cfg_attr(
    kani,
    kani::stub(
        crate::words::bits::set_range,
        crate::proofs::stubs::set_range_of_a_word
    )
)]
pub fn looking_around_adds_the_cells_within_the_radius() {
    let before = between(0, (1 << (SIDE * SIDE)) - 1);
    let (x, y) = (between(0, SIDE - 1) as u32, between(0, SIDE - 1) as u32);
    let squared = between(0, 8) as u32;
    let mut map = [before];
    let side = SIDE as u32;
    Disc::from_squared(squared).mark(&mut map, Cell { x, y }, side, side);
    kani::cover!(squared == 0, "its own cell alone");
    kani::cover!(squared == 8, "the whole grid");
    kani::cover!(squared == 2 && x == 0, "a disc cut off by the edge");
    let (at_x, at_y) = (between(0, SIDE - 1), between(0, SIDE - 1));
    let (dx, dy) = (x.abs_diff(at_x as u32), y.abs_diff(at_y as u32));
    let bit = at_y * SIDE + at_x;
    let within = dx * dx + dy * dy <= squared;
    assert!((map[0] >> bit & 1 == 1) == (within || before >> bit & 1 == 1));
}

/// The reach of a disc is the whole part of its radius.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(6))]
pub fn a_disc_reaches_as_far_as_its_radius() {
    let squared = between(0, 24) as u32;
    let reach = Disc::from_squared(squared).reach;
    kani::cover!(reach == 0, "its own cell alone");
    kani::cover!(reach * reach == squared && reach > 1, "a whole radius");
    assert!(reach * reach <= squared && squared < (reach + 1) * (reach + 1));
}

#[cfg(not(kani))]
super::standin::twins! {
    looking_around_adds_the_cells_within_the_radius: 2000 cases, 3 covers;
    a_disc_reaches_as_far_as_its_radius: 1000 cases, 2 covers;
}

/// Every cell, grid and radius that one word of map has room for.
#[cfg(test)]
mod exhaustive {
    use super::*;
    use crate::words::bits;

    /// Every cell of the map afterwards was there before or lies within the radius.
    fn marks_the_cells_within(before: u64, cell: Cell, squared: u32, width: u32, height: u32) {
        let mut map = [before];
        Disc::from_squared(squared).mark(&mut map, cell, width, height);
        for y in 0..height {
            for x in 0..width {
                let (dx, dy) = (x.abs_diff(cell.x), y.abs_diff(cell.y));
                let index = (y * width + x) as usize;
                let within = dx * dx + dy * dy <= squared;
                assert!(bits::get(&map, index) == (within || bits::get(&[before], index)));
            }
        }
        assert!(map[0] & before == before);
        assert!(map[0] >> (width * height - 1) >> 1 == before >> (width * height - 1) >> 1);
    }

    #[test]
    fn every_cell_of_every_small_grid() {
        for (width, height) in [(1, 1), (1, 8), (8, 1), (3, 5), (8, 8)] {
            for squared in 0..=100 {
                for index in 0..width * height {
                    let cell = Cell {
                        x: index % width,
                        y: index / width,
                    };
                    marks_the_cells_within(0, cell, squared, width, height);
                    marks_the_cells_within(0x5a5a_1234_dead_0f0f, cell, squared, width, height);
                }
            }
        }
    }

    /// Squares of half-whole radii, whole ones and one beyond every grid.
    #[test]
    fn radii_in_metres_become_squares_in_cells() {
        let squared =
            |radius_m: f64| Disc::from_radius(radius_m, crate::Config::default().cell_size_m);
        assert_eq!(squared(0.0), Disc::from_squared(0));
        assert_eq!(squared(75.0), Disc::from_squared(2));
        assert_eq!(squared(150.0), Disc::from_squared(9));
        assert_eq!(squared(1e6), Disc::from_squared(Disc::SQUARED_MAX));
    }
}
