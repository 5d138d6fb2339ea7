//! Cells, and the depots as a list of them.

use super::list::{Element, List};

/// Largest number of depots of a configuration.
pub const MAX_DEPOTS: usize = 16;

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

impl Element for Cell {
    const BLANK: Self = Self { x: 0, y: 0 };
    const NAMES: &'static str = "cells [x, y]";
}

/// A list of up to [`MAX_DEPOTS`] cells.
pub type Depots = List<Cell, MAX_DEPOTS>;

impl Depots {
    /// No cell given: one depot in the centre of the grid.
    pub const CENTRE: Self = Self::EMPTY;

    /// One depot.
    #[must_use]
    pub fn one(cell: Cell) -> Self {
        let mut depots = Self::EMPTY;
        // There is room for one.
        let _ = depots.push(cell);
        depots
    }
}
