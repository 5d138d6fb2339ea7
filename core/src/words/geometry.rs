//! Cells of a grid, distances between them, and discs of cells.

use super::bits;

/// A cell of the grid: x in 0..W, y in 0..H. In files a pair `[x, y]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "(u32, u32)", into = "(u32, u32)"))]
pub struct Cell {
    /// Column, from 0 to W - 1.
    pub x: u32,
    /// Row, from 0 to H - 1; up is +y.
    pub y: u32,
}

impl From<(u32, u32)> for Cell {
    fn from((x, y): (u32, u32)) -> Self {
        Self { x, y }
    }
}

impl From<Cell> for (u32, u32) {
    fn from(cell: Cell) -> Self {
        (cell.x, cell.y)
    }
}

impl Cell {
    /// Manhattan distance in cells.
    #[inline]
    #[must_use]
    pub const fn manhattan(self, other: Self) -> u32 {
        self.x.abs_diff(other.x) + self.y.abs_diff(other.y)
    }

    /// One word of the state.
    #[inline]
    #[must_use]
    pub const fn to_word(self) -> u64 {
        self.x as u64 | (self.y as u64) << 32
    }

    /// The cell of a word of the state.
    #[inline]
    #[must_use]
    pub const fn from_word(word: u64) -> Self {
        Self {
            x: word as u32,
            y: (word >> 32) as u32,
        }
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

/// The disc of cells that a UAV searches: offsets from its own cell with Δx² + Δy² ≤ `squared`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Disc {
    pub(crate) squared: u32,
    pub(crate) reach: u32,
}

impl Disc {
    /// The longest squared distance on the largest grid.
    pub(crate) const SQUARED_MAX: u32 = 2 * 1023 * 1023;

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
