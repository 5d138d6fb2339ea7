//! The entries that the configuration adds to an observation.
//!
//! They are a window of the search map, unsearched fractions and a tag, then windows of the reports
//! and the nearest reported cells.

use super::unsearched::unsearched_shares;
use super::{View, flag, index_tag};
use crate::config::Cell;
use crate::constants::observation::{REPORT, lens, window_cells};
use crate::rules::reports;
use crate::words::bits;

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
