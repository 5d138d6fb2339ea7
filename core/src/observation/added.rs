//! The entries that the configuration adds to an observation.
//!
//! They are a window of the search map, unsearched fractions and a tag, then windows of the reports
//! and the nearest reported cells.

use super::{View, flag, index_tag};
use crate::config::{Cell, Config, MapDirections, SearchMaps, UavTag};
use crate::rules::reports;
use crate::words::bits;
use crate::words::geometry::{DIRECTIONS, unsearched_shares};

/// Number of entries for a reported cell.
pub(super) const REPORT: usize = 3;

/// Number of all entries that the configuration adds.
pub(crate) const fn added_len(config: &Config) -> usize {
    let mut sum = 0;
    let lens = lens(config);
    let mut index = 0;
    while index < lens.len() {
        sum += lens[index];
        index += 1;
    }
    sum
}

/// Number of entries of each part, in order: window of the search map, unsearched fractions, tag,
/// windows of the reports, reported cells.
pub(super) const fn lens(config: &Config) -> [usize; 5] {
    let window = window_cells(config);
    [
        match config.search_maps {
            SearchMaps::Off => 0,
            SearchMaps::Shared => window,
        },
        match config.map_directions {
            MapDirections::Off => 0,
            MapDirections::Shown => DIRECTIONS,
        },
        match config.uav_tag {
            UavTag::Off => 0,
            UavTag::Index => 1,
        },
        config.report_levels as usize * window,
        config.report_slots as usize * REPORT,
    ]
}

/// Number of cells of a window: (2 r + 1)², or 0.
const fn window_cells(config: &Config) -> usize {
    match config.map_window_radius as usize {
        0 => 0,
        radius => (2 * radius + 1) * (2 * radius + 1),
    }
}

impl View<'_> {
    /// Writes the entries that the configuration adds.
    pub(super) fn write_added(&self, i: usize, out: &mut [f32]) {
        let (config, cell) = (self.model.config(), self.state.cell(i));
        let [window, directions, tag, report_windows, _] = lens(config);
        let (window, rest) = out.split_at_mut(window);
        let (directions, rest) = rest.split_at_mut(directions);
        let (tag, rest) = rest.split_at_mut(tag);
        let (report_windows, nearest) = rest.split_at_mut(report_windows);
        let map = self.state.searched_of(i);
        if !window.is_empty() {
            self.write_window(cell, window, |index| !bits::get(map, index));
        }
        if !directions.is_empty() {
            unsearched_shares(map, cell, config.grid_width, config.grid_height, directions);
        }
        if let Some(tag) = tag.first_mut() {
            *tag = index_tag(i, self.model.uav_count());
        }
        if !report_windows.is_empty() {
            let levels = self.state.reports_of(i);
            let windows = report_windows.chunks_exact_mut(window_cells(config));
            for (window, set) in windows.zip(levels.chunks_exact(self.model.layout().false_cells)) {
                self.write_window(cell, window, |index| bits::get(set, index));
            }
        }
        if !nearest.is_empty() {
            self.write_nearest(i, nearest);
        }
    }

    /// Writes the cells around a cell, row by row from -y. A value is 1 in a set, 0 not in it, and
    /// -1 off the grid.
    ///
    /// `is_in` gives the membership of a row-major index.
    fn write_window(&self, cell: Cell, out: &mut [f32], is_in: impl Fn(usize) -> bool) {
        let radius = self.model.config().map_window_radius;
        let side = 2 * radius + 1;
        for (row, dy) in out.chunks_exact_mut(side as usize).zip(0..side) {
            for (value, dx) in row.iter_mut().zip(0..side) {
                // A cell below 0 wraps to a number above any size.
                let x = (cell.x + dx).wrapping_sub(radius);
                let y = (cell.y + dy).wrapping_sub(radius);
                let there = Cell { x, y };
                *value = if self.model.contains(there) {
                    flag(is_in(self.model.cell_index(there)))
                } else {
                    -1.0
                };
            }
        }
    }

    /// Writes (Δx/(W-1), Δy/(H-1), level/L) of the nearest reported cells, and zeros for the slots
    /// that remain.
    fn write_nearest(&self, i: usize, out: &mut [f32]) {
        let slots = out.len() / REPORT;
        let (found, count) = reports::nearest(self.model, self.state, i, slots);
        let (filled, empty) = out.split_at_mut(REPORT * count);
        let levels = self.model.config().report_levels as f32;
        let from = self.offsets_from(self.state.cell(i));
        for (row, &there) in filled.chunks_exact_mut(REPORT).zip(&found) {
            let (dx, dy) = from.to(there);
            let level = self.state.report_level(i, self.model.cell_index(there));
            row.copy_from_slice(&[dx, dy, level as f32 / levels]);
        }
        empty.fill(0.0);
    }
}
