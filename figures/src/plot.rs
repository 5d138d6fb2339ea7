//! Draws axes and series of a [`Figure`] in a rectangle of the page.

use super::canvas::{Align, Canvas, Place};
use super::font::text_width;
use super::palette::{AXIS, Colour, GRID, MUTED, PAPER, TEXT, look};
use super::scale::{Extent, Scale, number};
use super::style::{CAPTION, LABEL, NOTE};
use super::{Axis, Figure, Interval, Mark, Point, Series};

/// Series over the same x are shifted sideways by this share of the width, so that no whisker hides
/// another.
const DODGE: f64 = 0.006;

/// The largest number of values that an axis labels one by one.
const MOST_LABELLED: usize = 12;

/// A rectangle of the page, in CSS pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rect {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Figure {
    pub(super) fn y_values(&self) -> impl Iterator<Item = f64> + '_ {
        let points = self.series.iter().flat_map(|series| &series.points);
        let bars = self
            .series
            .iter()
            .any(|series| series.style.mark == Mark::Bars);
        points
            .filter(|point| point.is_drawn())
            .flat_map(|point| [point.y, point.y_low, point.y_high])
            .chain(self.references.iter().map(|reference| reference.y))
            .chain(span(&self.y_axis))
            .chain(bars.then_some(0.0))
            .filter(|value| !self.y_axis.logarithmic || *value > 0.0)
    }

    fn x_values(&self) -> impl Iterator<Item = f64> + '_ {
        let points = self.series.iter().flat_map(|series| &series.points);
        points
            .filter(|point| point.is_drawn())
            .flat_map(|point| [point.x, point.x_low, point.x_high])
            .chain(span(&self.x_axis))
            .filter(|value| !self.x_axis.logarithmic || *value > 0.0)
    }
}

fn span(axis: &Axis) -> impl Iterator<Item = f64> + use<> {
    axis.span.into_iter().flat_map(|(low, high)| [low, high])
}

/// The rectangle of the data with its two scales.
pub(super) struct Plot {
    pub frame: Rect,
    pub x: Scale,
    pub y: Scale,
}

impl Plot {
    /// Fits axes and their labels into a part of the page. A given extent replaces that of the
    /// data, so that several plots can share one axis.
    pub(super) fn new(figure: &Figure, page: Rect, y_extent: Option<&Extent>) -> Self {
        let own = Extent::of(figure.y_values());
        let y_extent = y_extent.unwrap_or(&own);
        let (top, bottom) = (page.top + 30.0, page.bottom - 48.0);
        let wanted = if bottom - top > 220.0 { 6 } else { 4 };
        let y = if figure.y_axis.logarithmic {
            Scale::logarithmic(y_extent, (bottom, top))
        } else {
            Scale::linear(y_extent, (bottom, top), wanted)
        };
        let widest = y
            .ticks
            .iter()
            .map(|(_, text)| text_width(text, LABEL.size, false))
            .fold(0.0, f64::max);
        let frame = Rect {
            left: page.left + widest + 10.0,
            top,
            right: page.right,
            bottom,
        };
        let x = x_scale(figure, frame);
        Self { frame, x, y }
    }

    /// Scale of the marks, which is smaller in a small plot.
    fn ink(&self) -> f64 {
        if self.frame.right - self.frame.left < 320.0 {
            0.75
        } else {
            1.0
        }
    }

    pub(super) fn at(&self, point: &Point) -> Place {
        (self.x.place(point.x), self.y.place(point.y))
    }

    pub(super) fn draw(&self, canvas: &mut Canvas, figure: &Figure, looks: &[usize]) {
        self.draw_axes(canvas, figure);
        if !figure
            .series
            .iter()
            .any(|series| series.points.iter().any(Point::is_drawn))
        {
            let Rect {
                left,
                top,
                right,
                bottom,
            } = self.frame;
            canvas.text(
                ((left + right) / 2.0, (top + bottom) / 2.0),
                "no data",
                NOTE,
                Align::Centre,
            );
            return;
        }
        let colour = |k: usize| look(looks[k]).0;
        let shifts = self.shifts(figure);
        for (k, series) in figure.series.iter().enumerate() {
            if series.style.interval == Interval::Band {
                self.draw_band(canvas, series, colour(k));
            }
        }
        for (k, series) in figure.series.iter().enumerate() {
            if series.style.mark == Mark::Bars {
                self.draw_bars(canvas, series, colour(k), shifts[k], self.bar_width(figure));
            }
        }
        self.draw_references(canvas, figure);
        for (k, series) in figure.series.iter().enumerate() {
            self.draw_series(canvas, series, looks[k], shifts[k]);
        }
        self.draw_reference_labels(canvas, figure);
    }

    fn draw_axes(&self, canvas: &mut Canvas, figure: &Figure) {
        let Rect {
            left,
            top,
            right,
            bottom,
        } = self.frame;
        for (value, text) in &self.y.ticks {
            let y = self.y.place(*value);
            canvas.line(&[(left, y), (right, y)], GRID, 1.0, &[]);
            canvas.text((left - 8.0, y), text.as_str(), LABEL, Align::Right);
        }
        canvas.line(&[(left, bottom), (right, bottom)], AXIS, 1.0, &[]);
        let mut free_from = f64::NEG_INFINITY;
        for (value, text) in &self.x.ticks {
            let x = self.x.place(*value);
            canvas.line(&[(x, bottom), (x, bottom + 4.0)], AXIS, 1.0, &[]);
            let half = text_width(text, LABEL.size, false) / 2.0;
            if x - half >= free_from {
                canvas.text((x, bottom + 15.0), text.as_str(), LABEL, Align::Centre);
                free_from = x + half + 4.0;
            }
        }
        canvas.text(
            ((left + right) / 2.0, bottom + 37.0),
            figure.x_axis.caption(),
            CAPTION,
            Align::Centre,
        );
        let y_left = left
            - 8.0
            - self
                .y
                .ticks
                .iter()
                .map(|(_, text)| text_width(text, LABEL.size, false))
                .fold(0.0, f64::max);
        canvas.text(
            (y_left, top - 18.0),
            figure.y_axis.caption(),
            CAPTION,
            Align::Left,
        );
    }

    fn draw_references(&self, canvas: &mut Canvas, figure: &Figure) {
        for reference in figure
            .references
            .iter()
            .filter(|reference| reference.y.is_finite())
        {
            let y = self.y.place(reference.y);
            canvas.line(
                &[(self.frame.left, y), (self.frame.right, y)],
                MUTED,
                1.2,
                &[5.0, 4.0],
            );
        }
    }

    /// Draws the labels on a background, since a line of the data may pass there.
    fn draw_reference_labels(&self, canvas: &mut Canvas, figure: &Figure) {
        for reference in figure
            .references
            .iter()
            .filter(|reference| reference.y.is_finite())
        {
            let (right, y) = (self.frame.right - 4.0, self.y.place(reference.y) - 11.0);
            let width = text_width(&reference.label, NOTE.size, false);
            canvas.rectangle(
                (right - width - 3.0, y - 8.0),
                (right + 3.0, y + 8.0),
                PAPER.opacity(0.85),
            );
            canvas.text((right, y), reference.label.as_str(), NOTE, Align::Right);
        }
    }

    /// The sideways shift of each series.
    fn shifts(&self, figure: &Figure) -> Vec<f64> {
        let bars: Vec<usize> = positions(figure, |series| series.style.mark == Mark::Bars);
        let with_whiskers = |series: &Series| {
            series.style.mark != Mark::Bars
                && series.style.interval == Interval::Whiskers
                && series
                    .points
                    .iter()
                    .any(|point| point.y_low.is_finite() && !point.x_low.is_finite())
        };
        let lines: Vec<usize> = positions(figure, with_whiskers);
        let crowded = figure
            .series
            .iter()
            .any(|series| series.points.len() > MOST_LABELLED);
        let mut shifts = vec![0.0; figure.series.len()];
        let mut spread = |which: &[usize], by: f64| {
            for (place, k) in which.iter().enumerate() {
                shifts[*k] = (place as f64 - (which.len() as f64 - 1.0) / 2.0) * by;
            }
        };
        spread(&bars, self.bar_width(figure));
        if !crowded {
            spread(&lines, DODGE * (self.frame.right - self.frame.left));
        }
        shifts
    }

    /// The width of a bar: the bars of one position fill four fifths of the distance between
    /// positions.
    fn bar_width(&self, figure: &Figure) -> f64 {
        let bars = positions(figure, |series| series.style.mark == Mark::Bars)
            .len()
            .max(1);
        let places = distinct(figure.x_values());
        let gap = places
            .windows(2)
            .map(|pair| self.x.place(pair[1]) - self.x.place(pair[0]))
            .fold(self.frame.right - self.frame.left, f64::min);
        (0.8 * gap / bars as f64).min(60.0)
    }

    fn draw_band(&self, canvas: &mut Canvas, series: &Series, colour: Colour) {
        let bounded =
            |point: &Point| point.is_drawn() && point.y_low.is_finite() && point.y_high.is_finite();
        for run in series
            .points
            .split(|point| !bounded(point))
            .filter(|run| run.len() > 1)
        {
            let upper = run
                .iter()
                .map(|point| (self.x.place(point.x), self.y.place(point.y_high)));
            let lower = run
                .iter()
                .rev()
                .map(|point| (self.x.place(point.x), self.y.place(point.y_low)));
            canvas.fill(upper.chain(lower).collect(), colour.opacity(0.16));
        }
    }

    fn draw_bars(
        &self,
        canvas: &mut Canvas,
        series: &Series,
        colour: Colour,
        shift: f64,
        width: f64,
    ) {
        let base = self.y.place(self.y.base());
        for point in series.points.iter().filter(|point| point.is_drawn()) {
            let (x, y) = self.at(point);
            let (left, right) = (x + shift - width / 2.0 + 1.0, x + shift + width / 2.0 - 1.0);
            canvas.rectangle((left, y.min(base)), (right, y.max(base)), colour);
        }
    }

    fn draw_series(&self, canvas: &mut Canvas, series: &Series, index: usize, shift: f64) {
        let (colour, marker, dash) = look(index);
        let Series {
            points,
            style,
            labels,
            ..
        } = series;
        let place = |point: &Point| {
            let (x, y) = self.at(point);
            (x + shift, y)
        };
        if matches!(style.mark, Mark::Line | Mark::PlainLine) {
            for run in points
                .split(|point| !point.is_drawn())
                .filter(|run| run.len() > 1)
            {
                let line: Vec<Place> = run.iter().map(place).collect();
                canvas.line(&line, colour, 2.0 * self.ink(), dash);
            }
        }
        for (k, point) in points
            .iter()
            .enumerate()
            .filter(|(_, point)| point.is_drawn())
        {
            let at = place(point);
            if style.interval == Interval::Whiskers {
                let ink = if style.mark == Mark::Bars {
                    TEXT
                } else {
                    colour
                };
                self.draw_whiskers(canvas, point, at, ink);
            }
            if matches!(style.mark, Mark::Line | Mark::Points) {
                canvas.marker(at, marker, colour, self.ink());
            }
            if let Some(label) = labels.get(k) {
                canvas.text((at.0 + 8.0, at.1 - 9.0), label.as_str(), NOTE, Align::Left);
            }
        }
    }

    fn draw_whiskers(&self, canvas: &mut Canvas, point: &Point, (x, y): Place, colour: Colour) {
        const CAP: f64 = 3.0;
        if point.y_low.is_finite() && point.y_high.is_finite() {
            let (low, high) = (self.y.place(point.y_low), self.y.place(point.y_high));
            canvas.line(&[(x, low), (x, high)], colour, 1.3, &[]);
            for end in [low, high] {
                canvas.line(&[(x - CAP, end), (x + CAP, end)], colour, 1.3, &[]);
            }
        }
        if point.x_low.is_finite() && point.x_high.is_finite() {
            let (low, high) = (self.x.place(point.x_low), self.x.place(point.x_high));
            canvas.line(&[(low, y), (high, y)], colour, 1.3, &[]);
            for end in [low, high] {
                canvas.line(&[(end, y - CAP), (end, y + CAP)], colour, 1.3, &[]);
            }
        }
    }
}

fn x_scale(figure: &Figure, frame: Rect) -> Scale {
    let ends = (frame.left, frame.right);
    let names = &figure.x_axis.categories;
    if !names.is_empty() {
        let places: Vec<f64> = (0..names.len()).map(|k| k as f64).collect();
        let margin = 0.5 / (names.len() as f64 - 1.0).max(1.0);
        return Scale::at_values(&places, names.clone(), ends, margin);
    }
    let extent = Extent::of(figure.x_values());
    if figure.x_axis.logarithmic {
        return Scale::logarithmic(&extent, ends);
    }
    let values = distinct(figure.x_values());
    let few_whole =
        values.len() <= MOST_LABELLED && values.iter().all(|value| value.fract() == 0.0);
    if few_whole && !values.is_empty() {
        let texts = values.iter().map(|value| number(*value, 0)).collect();
        return Scale::at_values(&values, texts, ends, 0.06);
    }
    let wanted = if frame.right - frame.left > 400.0 {
        8
    } else {
        4
    };
    Scale::linear(&extent, ends, wanted).trimmed(&extent)
}

fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

fn positions(figure: &Figure, wanted: impl Fn(&Series) -> bool) -> Vec<usize> {
    (0..figure.series.len())
        .filter(|k| wanted(&figure.series[*k]))
        .collect()
}
