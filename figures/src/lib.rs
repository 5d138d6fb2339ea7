//! Draws figures as SVG and PNG from one description, the same on every machine.
//!
//! - [`Figure`]: series over a numeric or categorical axis, with bands or whiskers;
//! - [`Panels`]: several figures side by side;
//! - [`report`]: one HTML page of text, figures and tables.
//!
//! People with any colour vision can distinguish the colours. Each series also has its own marker
//! and dash, so that a print without colour is readable.

#![forbid(unsafe_code)]

mod canvas;
mod chart;
mod font;
mod legend;
mod output;
mod palette;
mod panels;
mod plot;
pub mod report;
mod scale;
mod style;

pub use output::{Draw, FigureError};
pub use panels::Panels;

/// Width of a figure in CSS pixels; the PNG has twice as many.
pub const WIDTH: u32 = 800;
/// Height of a figure in CSS pixels.
pub const HEIGHT: u32 = 500;

/// A chart of series over an axis.
#[derive(Clone, Debug)]
pub struct Figure {
    /// The title, in one line.
    pub title: String,
    /// A line under the title: conditions, sample size, what the intervals are.
    pub note: String,
    /// The horizontal axis.
    pub x_axis: Axis,
    /// The vertical axis.
    pub y_axis: Axis,
    /// The compared series, in the order of the legend.
    pub series: Vec<Series>,
    /// Horizontal lines at reference values.
    pub references: Vec<Reference>,
}

/// One axis.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// The quantity.
    pub label: String,
    /// Its unit; empty for a plain number.
    pub unit: String,
    /// Names of the positions 0, 1, 2 and so on; empty for a numeric axis.
    pub categories: Vec<String>,
    /// Limits that the axis spans at least; `None` fits the data.
    pub span: Option<(f64, f64)>,
    /// Whether the axis is logarithmic; its values must then be positive.
    pub logarithmic: bool,
}

/// A series: the points of one name in the legend.
#[derive(Clone, Debug)]
pub struct Series {
    /// The name in the legend.
    pub name: String,
    /// The points in the order in which a line joins them. Non-finite points leave a gap.
    pub points: Vec<Point>,
    /// The drawing style.
    pub style: Style,
    /// Texts beside the points, in the order of the points; may be empty.
    pub labels: Vec<String>,
}

/// A value with its interval; non-finite bounds are not drawn.
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

/// The drawing style of a series.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Style {
    /// The mark.
    pub mark: Mark,
    /// The form in which intervals are shown.
    pub interval: Interval,
    /// Index of the colour, marker and dash in the palette; `None` takes the series' position in
    /// the figure. Equal things in different figures of a report should have equal indices.
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

/// The form in which an interval is shown.
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
    /// The value.
    pub y: f64,
    /// The label of the line.
    pub label: String,
}

impl Figure {
    /// Builds a figure without series.
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
    /// Builds a numeric axis that fits the data.
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            unit: unit.into(),
            ..Self::default()
        }
    }

    /// Builds an axis with names for the positions 0, 1, 2 and so on.
    #[must_use]
    pub fn categories<T: Into<String>>(mut self, names: impl IntoIterator<Item = T>) -> Self {
        self.categories = names.into_iter().map(Into::into).collect();
        self
    }

    /// Sets limits that the axis spans at least.
    #[must_use]
    pub fn span(mut self, low: f64, high: f64) -> Self {
        self.span = Some((low, high));
        self
    }

    /// Makes the axis logarithmic.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.logarithmic = true;
        self
    }

    /// The label of an axis: quantity and unit.
    pub(crate) fn caption(&self) -> String {
        if self.unit.is_empty() {
            self.label.clone()
        } else {
            format!("{} ({})", self.label, self.unit)
        }
    }
}

impl Series {
    /// Builds a line with markers and whiskers.
    pub fn line(name: impl Into<String>, points: Vec<Point>) -> Self {
        Self {
            name: name.into(),
            points,
            style: Style::default(),
            labels: Vec::new(),
        }
    }

    /// Builds a line without markers inside a band, for many points.
    pub fn band(name: impl Into<String>, points: Vec<Point>) -> Self {
        Self::line(name, points).styled(Mark::PlainLine, Interval::Band)
    }

    /// Builds markers with whiskers.
    pub fn points(name: impl Into<String>, points: Vec<Point>) -> Self {
        Self::line(name, points).styled(Mark::Points, Interval::Whiskers)
    }

    /// Builds bars with whiskers.
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

    /// Sets a text beside each point.
    #[must_use]
    pub fn labels<T: Into<String>>(mut self, labels: impl IntoIterator<Item = T>) -> Self {
        self.labels = labels.into_iter().map(Into::into).collect();
        self
    }

    /// Sets the index in the palette.
    #[must_use]
    pub fn palette(mut self, index: usize) -> Self {
        self.style.palette = Some(index);
        self
    }
}

impl Point {
    /// Builds a point without an interval.
    pub fn new(x: f64, y: f64) -> Self {
        Self::interval(x, y, f64::NAN, f64::NAN)
    }

    /// Builds a point with an interval of y.
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
