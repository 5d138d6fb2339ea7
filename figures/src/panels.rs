//! Several figures side by side with one legend.

use super::Figure;
use super::canvas::{Align, Canvas};
use super::legend::{self, Name, ROW_HEIGHT};
use super::output::Draw;
use super::plot::{Plot, Rect};
use super::scale::Extent;
use super::style::{CAPTION, MARGIN, header};

/// Figures that share their vertical axis, their names and colours.
#[derive(Clone, Debug)]
pub struct Panels {
    /// The title of the whole.
    pub title: String,
    /// A line under the title.
    pub note: String,
    /// Number of panels in a row.
    pub columns: usize,
    /// The panels, row by row, each with its title above. Series of the same name look the same.
    pub figures: Vec<Figure>,
}

const PANEL_WIDTH: f64 = 280.0;
const PANEL_HEIGHT: f64 = 250.0;

impl Panels {
    fn rows(&self) -> usize {
        self.figures.len().div_ceil(self.columns.max(1))
    }

    /// Height of the header as drawn.
    fn header_height(&self) -> f64 {
        header(
            &mut Canvas::default(),
            &self.title,
            &self.note,
            self.width(),
        )
    }

    fn width(&self) -> f64 {
        2.0 * MARGIN + PANEL_WIDTH * self.columns.max(1) as f64
    }

    /// Whether the last row has room for the legend.
    fn has_free_place(&self, names: &[Name]) -> bool {
        let places = self.rows() * self.columns.max(1);
        places > self.figures.len()
            && names
                .iter()
                .all(|name| legend::name_width(name) < PANEL_WIDTH - 20.0)
            && names.len() as f64 * ROW_HEIGHT < PANEL_HEIGHT - 60.0
    }

    fn legend_height(&self) -> f64 {
        let names = self.names();
        if names.len() < 2 || self.has_free_place(&names) {
            return 6.0;
        }
        legend::rows(&names, self.width()).len() as f64 * ROW_HEIGHT + 12.0
    }

    /// The legend entry of each series, in the order of first appearance.
    fn names(&self) -> Vec<Name> {
        let mut names: Vec<Name> = Vec::new();
        for series in self.figures.iter().flat_map(|figure| &figure.series) {
            if names.iter().all(|(name, ..)| *name != series.name) {
                let index = series.style.palette.unwrap_or(names.len());
                names.push((series.name.clone(), index, series.style.mark));
            }
        }
        names
    }
}

impl Draw for Panels {
    fn size(&self) -> (u32, u32) {
        let height =
            self.header_height() + PANEL_HEIGHT * self.rows() as f64 + self.legend_height();
        (self.width() as u32, height as u32)
    }

    fn description(&self) -> String {
        let panels: Vec<String> = self.figures.iter().map(Draw::description).collect();
        format!("{}: {}", self.title, panels.join("; "))
    }

    fn draw(&self, canvas: &mut Canvas) {
        let top = header(canvas, &self.title, &self.note, self.width());
        let names = self.names();
        let y_extent = Extent::of(self.figures.iter().flat_map(Figure::y_values));
        for (k, figure) in self.figures.iter().enumerate() {
            let (row, column) = (k / self.columns.max(1), k % self.columns.max(1));
            let left = MARGIN + PANEL_WIDTH * column as f64;
            let above = top + PANEL_HEIGHT * row as f64;
            let page = Rect {
                left,
                top: above + 16.0,
                right: left + PANEL_WIDTH - 18.0,
                bottom: above + PANEL_HEIGHT - 4.0,
            };
            let mut figure = figure.clone();
            if column > 0 {
                (figure.y_axis.label, figure.y_axis.unit) = (String::new(), String::new());
            }
            let plot = Plot::new(&figure, page, Some(&y_extent));
            canvas.text(
                ((plot.frame.left + plot.frame.right) / 2.0, above + 10.0),
                figure.title.as_str(),
                CAPTION,
                Align::Centre,
            );
            let looks: Vec<usize> = figure
                .series
                .iter()
                .map(|series| {
                    names
                        .iter()
                        .find(|(name, ..)| *name == series.name)
                        .map_or(0, |found| found.1)
                })
                .collect();
            plot.draw(canvas, &figure, &looks);
        }
        if names.len() > 1 && self.has_free_place(&names) {
            let column = self.figures.len() % self.columns.max(1);
            let left = MARGIN + PANEL_WIDTH * column as f64 + 36.0;
            let above = top + PANEL_HEIGHT * (self.rows() - 1) as f64;
            legend::draw_list(canvas, &names, (left, above + 56.0));
        } else if names.len() > 1 {
            let above = top + PANEL_HEIGHT * self.rows() as f64;
            legend::draw_rows(canvas, &names, above + 12.0, self.width());
        }
    }
}
