//! Cells of a block's UAVs, and tables over their offsets to a cell.

use super::gather::{gather_bytes, gather_words, in_bytes};
use super::{Block, Lanes, force_vector};
use crate::words::geometry::Cell;

/// Cells, one for each lane of a block.
#[derive(Clone, Copy)]
pub(crate) struct Cells<const W: usize> {
    pub(crate) x: Lanes<i32, W>,
    pub(crate) y: Lanes<i32, W>,
}

impl<const W: usize> Cells<W> {
    #[inline(always)]
    pub(crate) fn load(block: Block<W>, words: &[u64]) -> Self {
        Self::of(&block.load(words))
    }

    #[inline(always)]
    pub(crate) fn of(words: &Lanes<u64, W>) -> Self {
        let (mut x, mut y) = ([0; W], [0; W]);
        for lane in 0..W {
            x[lane] = words[lane] as u32 as i32;
            y[lane] = (words[lane] >> 32) as i32;
        }
        force_vector(&mut x);
        force_vector(&mut y);
        Self { x, y }
    }

    /// Row-major indices of the cells in a grid of this width.
    #[inline(always)]
    pub(crate) fn index(&self, width: u32) -> Lanes<u32, W> {
        let mut index = [0; W];
        for lane in 0..W {
            index[lane] = (self.y[lane] * width as i32 + self.x[lane]) as u32;
        }
        force_vector(&mut index);
        index
    }

    /// The cells as columns and row offsets in a grid of this width.
    #[inline(always)]
    pub(crate) fn rows(&self, width: u32) -> Rows<W> {
        let mut begin = [0; W];
        for lane in 0..W {
            begin[lane] = self.y[lane] * width as i32;
        }
        force_vector(&mut begin);
        let (mut byte_x, mut byte_begin) = ([0; W], [0; W]);
        for lane in 0..W {
            byte_x[lane] = self.x[lane] as u8;
            byte_begin[lane] = begin[lane] as u8;
        }
        force_vector(&mut byte_x);
        force_vector(&mut byte_begin);
        Rows {
            x: self.x,
            begin,
            byte_x,
            byte_begin,
        }
    }
}

/// Cells in a grid, one for each lane: their columns, and the indices at which their rows begin.
#[derive(Clone, Copy)]
pub(crate) struct Rows<const W: usize> {
    x: Lanes<i32, W>,
    begin: Lanes<i32, W>,
    /// `x` and `begin` as bytes, for a grid of at most 256 cells.
    byte_x: Lanes<u8, W>,
    byte_begin: Lanes<u8, W>,
}

impl<const W: usize> Rows<W> {
    /// Gathers the words of a table at the row-major index of the absolute offset to a cell.
    ///
    /// The table has `len` entries; `table` may hold more words after it.
    #[inline(always)]
    pub(crate) fn gather(
        &self,
        table: &[u64],
        len: usize,
        to: Cell,
        width: u32,
        words: &mut Lanes<u64, W>,
    ) {
        match in_bytes::<W>(table, len) {
            Some(table) => gather_bytes(table, self.byte_offsets(to, width), words),
            None => gather_words(table, self.offsets(to, width), words),
        }
    }

    #[inline(always)]
    pub(crate) fn offsets(&self, to: Cell, width: u32) -> Lanes<u32, W> {
        let (x, begin) = (to.x as i32, (to.y * width) as i32);
        let mut index = [0; W];
        for lane in 0..W {
            index[lane] =
                (self.begin[lane] - begin).unsigned_abs() + (self.x[lane] - x).unsigned_abs();
        }
        index
    }

    #[inline(always)]
    pub(crate) fn byte_offsets(&self, to: Cell, width: u32) -> Lanes<u8, W> {
        let (x, begin) = (to.x as u8, (to.y * width) as u8);
        let mut index = [0; W];
        for lane in 0..W {
            index[lane] = (self.byte_begin[lane].max(begin) - self.byte_begin[lane].min(begin))
                + (self.byte_x[lane].max(x) - self.byte_x[lane].min(x));
        }
        index
    }
}
