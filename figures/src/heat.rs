//! A table of numbers, each on a colour that darkens with the value.

use super::Axis;
use super::canvas::{Align, Canvas, Type};
use super::font::text_width;
use super::output::Draw;
use super::palette::{Colour, GRID, PAPER, TEXT, heat};
use super::scale::{Extent, number, short_number};
use super::style::{CAPTION, LABEL, MARGIN, NOTE, header};

/// A heat table: categories across and down, one value for each pair.
#[derive(Clone, Debug)]
pub struct HeatTable {
    /// The title of the table.
    pub title: String,
    /// A line under the title.
    pub note: String,
    /// The quantity and unit of the values; its span, if given, is that of the colours.
    pub value: Axis,
    /// The horizontal axis: `categories` are the heads of the columns.
    pub columns: Axis,
    /// The vertical axis: `categories` are the heads of the rows.
    pub rows: Axis,
    /// The values by row, then column; a missing or non-finite value is left blank.
    pub cells: Vec<Vec<Option<f64>>>,
    /// Digits after the decimal point; `None` gives three significant digits.
    pub decimals: Option<usize>,
}

/// Least size of a cell; the cells of a small table grow until the caption beside them fits.
const CELL: (f64, f64) = (84.0, 40.0);
const KEY_HEIGHT: f64 = 46.0;

impl HeatTable {
    fn cell(&self) -> (f64, f64) {
        let (width, height) = CELL;
        let share = |axis: &Axis| {
            text_width(&axis.caption(), CAPTION.size, true) / axis.categories.len().max(1) as f64
        };
        (
            share(&self.columns).max(width).ceil(),
            share(&self.rows).max(height).ceil(),
        )
    }

    fn head_width(&self) -> f64 {
        let heads = self
            .rows
            .categories
            .iter()
            .map(|head| text_width(head, LABEL.size, false));
        heads.fold(0.0, f64::max) + 40.0
    }

    fn extent(&self) -> Extent {
        let span = self
            .value
            .span
            .into_iter()
            .flat_map(|(low, high)| [low, high]);
        Extent::of(self.cells.iter().flatten().flatten().copied().chain(span))
    }

    fn text(&self, value: f64) -> String {
        self.decimals
            .map_or_else(|| short_number(value), |decimals| number(value, decimals))
    }

    fn draw_key(&self, canvas: &mut Canvas, extent: &Extent, left: f64, y: f64) {
        const STEPS: usize = 80;
        const WIDTH: f64 = 160.0;
        let caption = self.value.caption();
        canvas.text((left, y), caption.as_str(), CAPTION, Align::Left);
        let low = self.text(extent.low);
        let start = left + text_width(&caption, CAPTION.size, true) + 14.0;
        canvas.text((start, y), low.as_str(), LABEL, Align::Left);
        let bar = start + text_width(&low, LABEL.size, false) + 6.0;
        for k in 0..STEPS {
            let edge = |k: usize| (bar + WIDTH * k as f64 / STEPS as f64).round();
            let colour = heat(k as f64 / (STEPS - 1) as f64);
            canvas.rectangle((edge(k), y - 6.0), (edge(k + 1), y + 6.0), colour);
        }
        canvas.text(
            (bar + WIDTH + 6.0, y),
            self.text(extent.high),
            LABEL,
            Align::Left,
        );
    }
}

impl Draw for HeatTable {
    fn size(&self) -> (u32, u32) {
        let (columns, rows) = (self.columns.categories.len(), self.rows.categories.len());
        let (cell_width, cell_height) = self.cell();
        let width = 2.0 * MARGIN + self.head_width() + cell_width * columns as f64;
        let height = 66.0 + 52.0 + cell_height * rows as f64 + KEY_HEIGHT + 10.0;
        (width.max(480.0) as u32, height as u32)
    }

    fn description(&self) -> String {
        let [value, rows, columns] = [&self.value, &self.rows, &self.columns].map(Axis::caption);
        format!("{}: {value} by {rows} and {columns}", self.title)
    }

    fn draw(&self, canvas: &mut Canvas) {
        let (width, _) = self.size();
        let top = header(canvas, &self.title, &self.note, f64::from(width)) + 44.0;
        let left = MARGIN + self.head_width();
        let extent = self.extent();
        let (cell_width, cell_height) = self.cell();
        let (columns, rows) = (
            self.columns.categories.len() as f64,
            self.rows.categories.len() as f64,
        );
        canvas.text(
            (left + columns * cell_width / 2.0, top - 32.0),
            self.columns.caption(),
            CAPTION,
            Align::Centre,
        );
        canvas.upward_text(
            (MARGIN + 6.0, top + rows * cell_height / 2.0),
            self.rows.caption(),
            CAPTION,
        );
        for (k, head) in self.columns.categories.iter().enumerate() {
            canvas.text(
                (left + cell_width * (k as f64 + 0.5), top - 10.0),
                head.as_str(),
                LABEL,
                Align::Centre,
            );
        }
        for (row, head) in self.rows.categories.iter().enumerate() {
            let y = top + cell_height * row as f64;
            canvas.text(
                (left - 8.0, y + cell_height / 2.0),
                head.as_str(),
                LABEL,
                Align::Right,
            );
            for column in 0..self.columns.categories.len() {
                let value = self
                    .cells
                    .get(row)
                    .and_then(|cells| cells.get(column))
                    .copied()
                    .flatten();
                let x = left + cell_width * column as f64;
                self.draw_cell(
                    canvas,
                    (x, y),
                    value.filter(|value| value.is_finite()),
                    &extent,
                );
            }
        }
        self.draw_key(canvas, &extent, left, top + rows * cell_height + 26.0);
    }
}

impl HeatTable {
    fn draw_cell(
        &self,
        canvas: &mut Canvas,
        (x, y): (f64, f64),
        value: Option<f64>,
        extent: &Extent,
    ) {
        let (width, height) = self.cell();
        let (right, bottom) = (x + width - 2.0, y + height - 2.0);
        let middle = ((x + right) / 2.0, (y + bottom) / 2.0);
        let Some(value) = value else {
            canvas.rectangle((x, y), (right, bottom), GRID.opacity(0.5));
            return canvas.text(middle, "–", NOTE, Align::Centre);
        };
        let range = extent.high - extent.low;
        let share = if range > 0.0 {
            (value - extent.low) / range
        } else {
            0.5
        };
        canvas.rectangle((x, y), (right, bottom), heat(share));
        let colour: Colour = if share > 0.55 { PAPER } else { TEXT };
        canvas.text(
            middle,
            self.text(value),
            Type { colour, ..LABEL },
            Align::Centre,
        );
    }
}
