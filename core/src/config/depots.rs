//! Cells, and the depots as a list of them.

use super::list::{Element, List};
pub use crate::words::geometry::Cell;

/// Largest number of depots of a configuration.
pub const MAX_DEPOTS: usize = 16;

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
