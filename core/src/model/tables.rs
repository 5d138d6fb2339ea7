//! The tables of a model: quantities over the offset between two cells, and of each cell.

use super::Model;
use crate::config::{Cell, Config};
use crate::lanes::{self, Cells, Lanes, Rows};
use crate::radio::radar::curve;
use crate::radio::{false_alarms, link, radar};
use crate::words::geometry::nearest;

/// The memory of a model's tables: the caller's, or with the feature `alloc` the model's own.
#[derive(Clone, Debug)]
pub(super) enum Words<'m> {
    Borrowed(&'m [u64]),
    #[cfg(feature = "alloc")]
    Owned(alloc::vec::Vec<u64>),
}

/// The position at which each table begins, in words.
pub(super) struct Tables {
    pub(super) link: usize,
    pub(super) depot: usize,
    pub(super) offset_x: usize,
    pub(super) offset_y: usize,
    pub(super) end: usize,
}

impl Tables {
    /// The radar table comes first; the link and depot tables have the same length.
    pub(super) const fn of(width: u32, height: u32) -> Self {
        let cells = width as usize * height as usize;
        let offset_x = 3 * cells;
        let offset_y = offset_x + 2 * width as usize - 1;
        Self {
            link: cells,
            depot: 2 * cells,
            offset_x,
            offset_y,
            end: offset_y + 2 * height as usize - 1,
        }
    }
}

/// A table over the absolute offset between two cells.
#[derive(Clone, Copy)]
pub(crate) struct OffsetTable<'t> {
    width: u32,
    /// Number of entries; the words after them belong to other tables.
    len: usize,
    values: &'t [u64],
}

impl OffsetTable<'_> {
    /// The value for two cells of the grid.
    #[inline(always)]
    pub(crate) fn between(self, a: Cell, b: Cell) -> f64 {
        let offset = a.y.abs_diff(b.y) * self.width + a.x.abs_diff(b.x);
        f64::from_bits(self.values[offset as usize])
    }

    /// The values for the cells of a block and one cell.
    #[inline(always)]
    pub(crate) fn gather<const W: usize>(self, rows: &Rows<W>, to: Cell) -> Lanes<f64, W> {
        let mut values = [0; W];
        self.gather_into(rows, to, &mut values);
        values.map(f64::from_bits)
    }

    /// Writes the values of [`Self::gather`] as bits of f64.
    #[inline(always)]
    pub(crate) fn gather_into<const W: usize>(
        self,
        rows: &Rows<W>,
        to: Cell,
        values: &mut Lanes<u64, W>,
    ) {
        rows.gather(self.values, self.len, to, self.width, values);
    }
}

/// Fills the tables of a model.
pub(super) fn fill(config: &Config, words: &mut [u64]) {
    let (width, height) = (config.grid_width, config.grid_height);
    let tables = Tables::of(width, height);
    let depots = config.effective_depots();
    for y in 0..height {
        for x in 0..width {
            let index = (y * width + x) as usize;
            let range_m = radar::range_m(config, x, y);
            words[index] = curve::tabulated(config, range_m).to_bits();
            words[tables.link + index] = link::full_throughput(config, range_m).to_bits();
            let (depot, distance) = nearest(Cell { x, y }, depots.as_slice());
            words[tables.depot + index] = depot as u64 | u64::from(distance) << 32;
        }
    }
    fill_offsets(&mut words[tables.offset_x..tables.offset_y], width);
    fill_offsets(&mut words[tables.offset_y..tables.end], height);
    false_alarms::tabulate(config, &mut words[tables.end..]);
}

/// Writes the offsets -(extent-1)..=(extent-1), divided by (extent - 1), as bits of f32. All are 0
/// where the grid is one cell wide.
fn fill_offsets(words: &mut [u64], extent: u32) {
    let span = f64::from(extent - 1);
    for (index, word) in words.iter_mut().enumerate() {
        let offset = index as f64 - span;
        let normalised = if span > 0.0 { offset / span } else { 0.0 };
        *word = u64::from((normalised as f32).to_bits());
    }
}

impl Model<'_> {
    /// The tables of false alarms; no words without them.
    #[inline]
    pub(crate) fn alarm_tables(&self) -> &[u64] {
        &self.words()[Tables::of(self.width, self.height).end..]
    }

    #[inline]
    pub(super) fn words(&self) -> &[u64] {
        match &self.tables {
            Words::Borrowed(words) => words,
            #[cfg(feature = "alloc")]
            Words::Owned(words) => words,
        }
    }

    /// The part of the probability of detection that depends on the distance between two cells: the
    /// value that the detection curve tabulates.
    #[inline]
    pub(crate) fn detection_table(&self) -> OffsetTable<'_> {
        OffsetTable {
            width: self.width,
            len: self.cells(),
            values: self.words(),
        }
    }

    /// Normalised throughput between two cells if the waveform carries only data.
    #[inline]
    pub(crate) fn full_throughput(&self) -> OffsetTable<'_> {
        OffsetTable {
            width: self.width,
            len: self.cells(),
            values: &self.words()[self.cells()..],
        }
    }

    #[inline]
    const fn cells(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The depot nearest to a cell, and its Manhattan distance in cells.
    #[inline]
    pub(crate) fn nearest_depot(&self, cell: Cell) -> (Cell, u32) {
        let word = self.words()[2 * self.cells() + self.cell_index(cell)];
        (
            self.depots.as_slice()[word as u32 as usize],
            (word >> 32) as u32,
        )
    }

    /// Manhattan distance to the nearest depot, in cells.
    #[inline]
    pub(crate) fn depot_distance(&self, cell: Cell) -> u32 {
        (self.words()[2 * self.cells() + self.cell_index(cell)] >> 32) as u32
    }

    /// Manhattan distance of each cell of a block to its nearest depot.
    #[inline(always)]
    pub(crate) fn depot_distances<const W: usize>(&self, cells: &Cells<W>) -> Lanes<u32, W> {
        let index = cells.index(self.width);
        lanes::gather(&self.words()[2 * self.cells()..], self.cells(), &index)
            .map(|word| (word >> 32) as u32)
    }

    /// Tables of normalised offsets along x and y, indexed by offset + extent - 1.
    #[inline]
    pub(crate) fn offset_tables(&self) -> (&[u64], &[u64]) {
        let tables = Tables::of(self.width, self.height);
        let words = self.words();
        (
            &words[tables.offset_x..tables.offset_y],
            &words[tables.offset_y..tables.end],
        )
    }
}
