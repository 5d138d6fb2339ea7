//! Figures as SVG and PNG from one description, the same on every machine.
//!
//! - [`Figure`]: series over a numeric or categorical axis, with bands or whiskers;
//! - [`Panels`]: several figures side by side;
//! - [`HeatTable`]: a table of numbers with a colour for each;
//! - [`report`]: one HTML page of text, figures and tables.
//!
//! Colours are told apart by people with any colour vision, and each series has its own marker and
//! dash as well, so that print without colour can be read too.

#![forbid(unsafe_code)]

mod canvas;
mod chart;
mod font;
mod heat;
mod legend;
mod output;
mod palette;
mod panels;
mod plot;
pub mod report;
mod scale;
mod style;

pub use heat::HeatTable;
pub use output::{Draw, FigureError};
pub use panels::Panels;

/// Width of a figure in CSS pixels; the PNG has twice as many.
pub const WIDTH: u32 = 800;
/// Height of a figure in CSS pixels.
pub const HEIGHT: u32 = 500;

/// Series over an axis.
#[derive(Clone, Debug)]
pub struct Figure {
    /// What the figure shows, in one line.
    pub title: String,
    /// A line under the title: conditions, sample size, what the intervals are.
    pub note: String,
    /// What runs from left to right.
    pub x_axis: Axis,
    /// What runs from bottom to top.
    pub y_axis: Axis,
    /// What is compared, in the order of the legend.
    pub series: Vec<Series>,
    /// Horizontal lines to compare with.
    pub references: Vec<Reference>,
}

/// One axis.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// The quantity.
    pub label: String,
    /// Its unit; empty for a plain number.
    pub unit: String,
    /// Names of the places 0, 1, 2 …; empty for a numeric axis.
    pub categories: Vec<String>,
    /// Limits that the axis at least spans; without them it fits the data.
    pub span: Option<(f64, f64)>,
    /// Decades instead of equal steps; values must be positive.
    pub logarithmic: bool,
}

/// What belongs to one name of the legend.
#[derive(Clone, Debug)]
pub struct Series {
    /// As the legend writes it.
    pub name: String,
    /// In the order in which a line joins them. Points that are not finite leave a gap.
    pub points: Vec<Point>,
    /// How it is drawn.
    pub style: Style,
    /// Texts beside the points, in their order; may be empty.
    pub labels: Vec<String>,
}

/// A value with its interval; bounds that are not finite are not drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names are the fields of any error bar")]
pub struct Point {
    pub x: f64,
    pub y: f64,
    pub y_low: f64,
    pub y_high: f64,
    pub x_low: f64,
    pub x_high: f64,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Style {
    /// The mark.
    pub mark: Mark,
    /// How intervals are shown.
    pub interval: Interval,
    /// Which colour, marker and dash of the palette; by default the series' place in the figure.
    /// Give the same number to the same thing in all figures of a report.
    pub palette: Option<usize>,
}

/// The mark of a series.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mark {
    /// A line with a marker at each point.
    #[default]
    Line,
    /// A line without markers, for many points.
    PlainLine,
    /// Markers only.
    Points,
    /// Bars from zero, side by side: a grouped comparison.
    Bars,
}

/// How an interval is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interval {
    /// Error bars.
    #[default]
    Whiskers,
    /// A shaded band.
    Band,
}

/// A horizontal line at a known value, for instance one that was published.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Where.
    pub y: f64,
    /// What it is.
    pub label: String,
}

impl Figure {
    /// A figure without series.
    pub fn new(title: impl Into<String>, x_axis: Axis, y_axis: Axis) -> Self {
        Self {
            title: title.into(),
            note: String::new(),
            x_axis,
            y_axis,
            series: Vec::new(),
            references: Vec::new(),
        }
    }

    /// Sets the line under the title.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// Adds a series.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// Adds a horizontal line.
    #[must_use]
    pub fn reference(mut self, y: f64, label: impl Into<String>) -> Self {
        let label = label.into();
        self.references.push(Reference { y, label });
        self
    }
}

impl Axis {
    /// A numeric axis that fits the data.
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            unit: unit.into(),
            ..Self::default()
        }
    }

    /// Names the places 0, 1, 2 …
    #[must_use]
    pub fn categories<T: Into<String>>(mut self, names: impl IntoIterator<Item = T>) -> Self {
        self.categories = names.into_iter().map(Into::into).collect();
        self
    }

    /// The axis spans at least this.
    #[must_use]
    pub fn span(mut self, low: f64, high: f64) -> Self {
        self.span = Some((low, high));
        self
    }

    /// Decades instead of equal steps.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.logarithmic = true;
        self
    }

    /// Quantity and unit, as an axis is labelled.
    pub(crate) fn caption(&self) -> String {
        if self.unit.is_empty() {
            self.label.clone()
        } else {
            format!("{} ({})", self.label, self.unit)
        }
    }
}

impl Series {
    /// A line with markers and whiskers.
    pub fn line(name: impl Into<String>, points: Vec<Point>) -> Self {
        Self {
            name: name.into(),
            points,
            style: Style::default(),
            labels: Vec::new(),
        }
    }

    /// A line without markers inside a band, for many points.
    pub fn band(name: impl Into<String>, points: Vec<Point>) -> Self {
        Self::line(name, points).styled(Mark::PlainLine, Interval::Band)
    }

    /// Markers with whiskers.
    pub fn points(name: impl Into<String>, points: Vec<Point>) -> Self {
        Self::line(name, points).styled(Mark::Points, Interval::Whiskers)
    }

    /// Bars with whiskers.
    pub fn bars(name: impl Into<String>, points: Vec<Point>) -> Self {
        Self::line(name, points).styled(Mark::Bars, Interval::Whiskers)
    }

    /// Sets mark and interval.
    #[must_use]
    pub fn styled(mut self, mark: Mark, interval: Interval) -> Self {
        self.style.mark = mark;
        self.style.interval = interval;
        self
    }

    /// Writes a text beside each point.
    #[must_use]
    pub fn labels<T: Into<String>>(mut self, labels: impl IntoIterator<Item = T>) -> Self {
        self.labels = labels.into_iter().map(Into::into).collect();
        self
    }

    /// Sets the place in the palette.
    #[must_use]
    pub fn palette(mut self, index: usize) -> Self {
        self.style.palette = Some(index);
        self
    }
}

impl Point {
    /// Without an interval.
    pub fn new(x: f64, y: f64) -> Self {
        Self::interval(x, y, f64::NAN, f64::NAN)
    }

    /// With an interval of y.
    pub fn interval(x: f64, y: f64, y_low: f64, y_high: f64) -> Self {
        Self {
            x,
            y,
            y_low,
            y_high,
            x_low: f64::NAN,
            x_high: f64::NAN,
        }
    }

    /// Adds an interval of x.
    #[must_use]
    pub fn x_interval(mut self, x_low: f64, x_high: f64) -> Self {
        self.x_low = x_low;
        self.x_high = x_high;
        self
    }

    pub(crate) fn is_drawn(&self) -> bool {
        self.x.is_finite() && self.y.is_finite()
    }
}

#[cfg(test)]
mod tests;
