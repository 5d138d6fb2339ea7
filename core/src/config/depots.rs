//! Cells, and a list of them with a fixed capacity.

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

/// A list of up to [`MAX_DEPOTS`] cells.
#[derive(Clone, Copy, Debug)]
pub struct Depots {
    cells: [Cell; MAX_DEPOTS],
    count: usize,
}

impl PartialEq for Depots {
    fn eq(&self, other: &Self) -> bool {
        self.as_slice() == other.as_slice()
    }
}

impl Depots {
    /// No cell given: one depot in the centre of the grid.
    pub const CENTRE: Self = Self {
        cells: [Cell { x: 0, y: 0 }; MAX_DEPOTS],
        count: 0,
    };

    /// One depot.
    #[must_use]
    pub fn one(cell: Cell) -> Self {
        let mut depots = Self::CENTRE;
        depots.cells[0] = cell;
        depots.count = 1;
        depots
    }

    /// The given cells; `None` if there are more than [`MAX_DEPOTS`].
    #[must_use]
    pub fn from_slice(cells: &[Cell]) -> Option<Self> {
        let mut depots = Self::CENTRE;
        for cell in cells {
            depots.push(*cell)?;
        }
        Some(depots)
    }

    /// Adds a cell; `None` if the list is full.
    pub(super) fn push(&mut self, cell: Cell) -> Option<()> {
        *self.cells.get_mut(self.count)? = cell;
        self.count += 1;
        Some(())
    }

    /// The cells.
    #[must_use]
    pub fn as_slice(&self) -> &[Cell] {
        &self.cells[..self.count]
    }

    /// Number of cells in the list.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.count
    }

    /// Whether the list is empty.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }
}

#[cfg(feature = "serde")]
mod serde_impl {
    use super::{Cell, Depots, MAX_DEPOTS};
    use core::fmt;
    use serde::de::{Error, SeqAccess, Visitor};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    impl Serialize for Depots {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            serializer.collect_seq(self.as_slice())
        }
    }

    impl<'de> Deserialize<'de> for Depots {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            struct Cells;
            impl<'de> Visitor<'de> for Cells {
                type Value = Depots;
                fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                    write!(out, "a list of at most {MAX_DEPOTS} cells [x, y]")
                }
                fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Depots, A::Error> {
                    let mut depots = Depots::CENTRE;
                    while let Some(cell) = sequence.next_element::<Cell>()? {
                        depots
                            .push(cell)
                            .ok_or_else(|| A::Error::invalid_length(MAX_DEPOTS + 1, &self))?;
                    }
                    Ok(depots)
                }
            }
            deserializer.deserialize_seq(Cells)
        }
    }
}
