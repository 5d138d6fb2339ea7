//! Lays a [`Figure`] out on a page: header, plot, and a legend outside the data.

use super::canvas::Canvas;
use super::legend;
use super::output::Draw;
use super::plot::{Plot, Rect};
use super::style::{MARGIN, header};
use super::{Figure, HEIGHT, WIDTH};

impl Draw for Figure {
    fn size(&self) -> (u32, u32) {
        (WIDTH, HEIGHT)
    }

    fn description(&self) -> String {
        let names: Vec<&str> = self
            .series
            .iter()
            .map(|series| series.name.as_str())
            .collect();
        let (x, y) = (self.x_axis.caption(), self.y_axis.caption());
        format!("{}: {y} over {x}; {}", self.title, names.join(", "))
    }

    fn draw(&self, canvas: &mut Canvas) {
        let (width, height) = (f64::from(WIDTH), f64::from(HEIGHT));
        let top = header(canvas, &self.title, &self.note, width);
        let looks = self.looks();
        let legend_width = legend::width(&self.series);
        let page = Rect {
            left: MARGIN,
            top,
            right: width - MARGIN - legend_width,
            bottom: height - MARGIN + 6.0,
        };
        let plot = Plot::new(self, page, None);
        plot.draw(canvas, self, &looks);
        if legend_width > 0.0 {
            legend::draw(canvas, self, &looks, &plot);
        }
    }
}

impl Figure {
    /// The index in the palette of each series.
    fn looks(&self) -> Vec<usize> {
        (0..)
            .zip(&self.series)
            .map(|(k, series)| series.style.palette.unwrap_or(k))
            .collect()
    }
}
