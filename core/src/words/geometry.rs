//! Search maps: the cells that a UAV has searched, and the fractions of a map that are unsearched.
//! Maps spread over the radio graph as knowledge does ([`crate::rules::knowledge::consensus`]).

use crate::config::{Cell, Config};
use crate::words::bits;

/// The disc of cells that a UAV searches: offsets from its own cell with Δx² + Δy² ≤ `squared`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Disc {
    pub(crate) squared: u32,
    pub(crate) reach: u32,
}

impl Disc {
    /// The longest squared distance on the largest grid.
    pub(crate) const SQUARED_MAX: u32 = 2 * 1023 * 1023;

    /// The cells within `search_map_radius_m`.
    #[must_use]
    pub fn of(config: &Config) -> Self {
        Self::from_radius(config.search_map_radius_m, config.cell_size_m)
    }

    /// The cells within a radius, both in metres.
    #[must_use]
    pub fn from_radius(radius_m: f64, cell_size_m: f64) -> Self {
        let radius = radius_m / cell_size_m;
        let squared = radius * radius;
        Self::from_squared(if squared < f64::from(Self::SQUARED_MAX) {
            squared as u32
        } else {
            Self::SQUARED_MAX
        })
    }

    /// The offsets up to a squared distance, at most that of the largest grid.
    #[must_use]
    pub fn from_squared(squared: u32) -> Self {
        let mut reach = 0;
        while (reach + 1) * (reach + 1) <= squared && reach < 1023 {
            reach += 1;
        }
        Self { squared, reach }
    }

    /// Whether the disc has an offset.
    #[must_use]
    pub fn holds(self, dx: u32, dy: u32) -> bool {
        // Up to the reach, squares do not overflow.
        dx <= self.reach && dy <= self.reach && dx * dx + dy * dy <= self.squared
    }

    /// Adds the cells of a grid around `cell` to a set of row-major indices.
    pub fn mark(self, map: &mut [u64], cell: Cell, width: u32, height: u32) {
        let mut half = self.reach;
        for dy in 0..=self.reach {
            while half > 0 && half * half + dy * dy > self.squared {
                half -= 1;
            }
            let begin = cell.x.saturating_sub(half);
            let end = if cell.x + half < width {
                cell.x + half + 1
            } else {
                width
            };
            if cell.y + dy < height {
                let row = (cell.y + dy) * width;
                bits::set_range(map, (row + begin) as usize, (row + end) as usize);
            }
            if cell.y >= dy {
                let row = (cell.y - dy) * width;
                bits::set_range(map, (row + begin) as usize, (row + end) as usize);
            }
        }
    }
}

/// Number of directions for which an observation has the unsearched fraction.
pub const DIRECTIONS: usize = 8;

/// Writes the unsearched fraction of the cells in each direction from `cell`.
///
/// The order is right, up-right, up, and so on counterclockwise. A cell lies up if |Δx| < |Δy|/2,
/// right if |Δy| < |Δx|/2, and up-right between. A direction without cells has a fraction of 0.
pub(crate) fn unsearched_shares(map: &[u64], cell: Cell, width: u32, height: u32, out: &mut [f32]) {
    let (mut cells, mut searched) = ([0usize; DIRECTIONS], [0usize; DIRECTIONS]);
    for y in 0..height {
        let away = y.abs_diff(cell.y);
        // In this row, |Δx| below `straight` means up or down, and |Δx| above 2 `away` right or
        // left.
        let straight = if away == 0 { 1 } else { away.div_ceil(2) };
        let diagonal = 2 * away + 1;
        let row = (y * width) as usize;
        let sides = if y > cell.y { [3, 2, 1] } else { [5, 6, 7] };
        let bounds = [
            0,
            (cell.x + 1).saturating_sub(diagonal),
            (cell.x + 1).saturating_sub(straight),
            cell.x + straight,
            cell.x + diagonal,
            width,
        ];
        let directions = [4, sides[0], sides[1], sides[2], 0];
        for part in 0..directions.len() {
            let begin = at_most(bounds[part], width) as usize;
            let end = at_most(bounds[part + 1], width) as usize;
            // The UAV's own cell lies in no direction.
            let own = away == 0 && part == 2;
            if begin < end && !own {
                cells[directions[part]] += end - begin;
                searched[directions[part]] += bits::count_range(map, row + begin, row + end);
            }
        }
    }
    for direction in 0..DIRECTIONS {
        out[direction] = if cells[direction] == 0 {
            0.0
        } else {
            ((cells[direction] - searched[direction]) as f64 / cells[direction] as f64) as f32
        };
    }
}

fn at_most(value: u32, bound: u32) -> u32 {
    if value < bound { value } else { bound }
}
