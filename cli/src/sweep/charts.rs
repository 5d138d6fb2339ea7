//! Figures of a sweep: each quantity over each numeric axis.

use std::path::{Path, PathBuf};

use jcas_core::Config;
use jcas_figures::{Draw, Figure, Panels, Point, Series};

use super::plan::{Axis, SweepCell};
use super::store::Store;
use crate::error::CliError;
use crate::files;

/// The drawn quantities: column of the table, name of the file, label, unit, and whether it is a
/// share.
const QUANTITIES: [(&str, &str, &str, &str, bool); 4] = [
    ("success_rate", "success", "success rate", "", true),
    (
        "mission_steps_mean",
        "mission_time",
        MISSION_TIME,
        "steps",
        false,
    ),
    ("energy_kwh_mean", "energy", "energy spent", "kWh", false),
    (
        "throughput_mean",
        "throughput",
        "normalised throughput",
        "",
        false,
    ),
];
/// Maximum number of panels that remain readable in one figure.
const PANELS_MAX: usize = 12;
const PANEL_COLUMNS: usize = 3;

/// Draws each quantity over each axis with several numbers, as SVG and PNG. Returns the files.
pub fn draw(
    out: &Path,
    axes: &[Axis],
    cells: &[SweepCell],
    store: &Store,
    episodes: u64,
) -> Result<Vec<PathBuf>, CliError> {
    let mut written = Vec::new();
    for (name, figure) in figures(axes, cells, store, episodes) {
        written.extend(write(out, &name, figure.as_ref())?);
    }
    Ok(written)
}

/// A figure for each quantity over each axis with several numbers, with the name of its file.
pub fn figures(
    axes: &[Axis],
    cells: &[SweepCell],
    store: &Store,
    episodes: u64,
) -> Vec<(String, Box<dyn Draw>)> {
    let mut all: Vec<(String, Box<dyn Draw>)> = Vec::new();
    for x_axis in (0..axes.len()).filter(|&index| numbers(&axes[index]).is_some()) {
        let layout = Layout::new(axes, x_axis);
        for quantity in QUANTITIES {
            // A figure in which every share is 1 says no more than its title.
            let estimates = || (0..cells.len()).filter_map(|cell| store.estimate(cell, quantity.0));
            if quantity.4 && estimates().all(|estimate| estimate.value == 1.0) {
                continue;
            }
            let name = format!("{}_over_{}", quantity.1, axes[x_axis].name);
            let mut panels: Vec<Figure> = layout
                .facets(cells)
                .into_iter()
                .take(PANELS_MAX)
                .map(|facet| layout.figure(quantity, &facet, cells, store, episodes))
                .collect();
            if panels.len() == 1 {
                all.push((name, Box::new(panels.remove(0))));
            } else {
                let figure = Panels {
                    title: panels_title(quantity.2, &axes[x_axis]),
                    note: sampling(quantity.2, episodes),
                    columns: PANEL_COLUMNS.min(panels.len()),
                    figures: panels,
                };
                all.push((name, Box::new(figure)));
            }
        }
    }
    all
}

/// The note under a figure: the meaning of the whiskers, and the number of episodes for each point.
fn sampling(title: &str, episodes: u64) -> String {
    let mut note = format!("{episodes} episodes a point; whiskers: 95 % intervals.");
    if title == MISSION_TIME {
        note += " An episode without success counts with its horizon.";
    }
    note
}

const MISSION_TIME: &str = "mission time";

fn panels_title(quantity: &str, axis: &Axis) -> String {
    let mut title = format!("{quantity} over {}", scale(axis).name);
    title[..1].make_ascii_uppercase();
    title
}

fn write(out: &Path, name: &str, figure: &dyn Draw) -> Result<[PathBuf; 2], CliError> {
    let (svg, png) = (
        out.join(format!("{name}.svg")),
        out.join(format!("{name}.png")),
    );
    files::write_bytes(&svg, figure.svg().map_err(CliError::input)?.as_bytes())?;
    files::write_bytes(&png, &figure.png().map_err(CliError::input)?)?;
    Ok([svg, png])
}

/// The values of an axis, if they are several numbers.
fn numbers(axis: &Axis) -> Option<Vec<f64>> {
    let values: Option<Vec<f64>> = axis.values.iter().map(|text| text.parse().ok()).collect();
    values.filter(|values| values.len() > 1)
}

/// The roles of the axes: one is horizontal, some distinguish series, the rest distinguish panels.
struct Layout<'a> {
    axes: &'a [Axis],
    x_axis: usize,
    series_axes: Vec<usize>,
    facet_axes: Vec<usize>,
}

impl<'a> Layout<'a> {
    /// Policies and pilot modes are compared in one panel; without several of them, the next list
    /// is.
    fn new(axes: &'a [Axis], x_axis: usize) -> Self {
        let others: Vec<usize> = (0..axes.len())
            .filter(|&index| index != x_axis && axes[index].values.len() > 1)
            .collect();
        let who = |index: &usize| matches!(axes[*index].name.as_str(), "policy" | "pilot");
        let mut series_axes: Vec<usize> = others.iter().copied().filter(who).collect();
        if series_axes.is_empty() {
            series_axes.extend(others.first());
        }
        let facet_axes = others
            .into_iter()
            .filter(|index| !series_axes.contains(index))
            .collect();
        Self {
            axes,
            x_axis,
            series_axes,
            facet_axes,
        }
    }

    /// The combinations of values on some axes, in the order of the cells.
    fn combinations(axes: &[usize], cells: &[SweepCell]) -> Vec<Vec<String>> {
        let mut combinations: Vec<Vec<String>> = Vec::new();
        for cell in cells {
            let values = Self::values(axes, cell);
            if !combinations.contains(&values) {
                combinations.push(values);
            }
        }
        combinations
    }

    fn values(axes: &[usize], cell: &SweepCell) -> Vec<String> {
        axes.iter().map(|&axis| cell.values[axis].clone()).collect()
    }

    fn facets(&self, cells: &[SweepCell]) -> Vec<Vec<String>> {
        Self::combinations(&self.facet_axes, cells)
    }

    fn figure(
        &self,
        (column, _, title, unit, share): (&str, &str, &str, &str, bool),
        facet: &[String],
        cells: &[SweepCell],
        store: &Store,
        episodes: u64,
    ) -> Figure {
        let x_scale = scale(&self.axes[self.x_axis]);
        let x_axis = jcas_figures::Axis::new(x_scale.name, x_scale.unit);
        let mut y_axis = jcas_figures::Axis::new(title, unit);
        if share {
            y_axis = y_axis.span(0.0, 1.0);
        }
        let note = self.note(&sampling(title, episodes));
        let title = if facet.is_empty() {
            panels_title(title, &self.axes[self.x_axis])
        } else {
            self.names(&self.facet_axes, facet)
        };
        let mut figure = Figure::new(title, x_axis, y_axis).note(note);
        for values in Self::combinations(&self.series_axes, cells) {
            let points = cells
                .iter()
                .enumerate()
                .filter(|(_, cell)| {
                    Self::values(&self.facet_axes, cell) == facet
                        && Self::values(&self.series_axes, cell) == values
                })
                .filter_map(|(index, cell)| {
                    let x: f64 = cell.values[self.x_axis].parse().ok()?;
                    let x = x / x_scale.value;
                    let estimate = store.estimate(index, column)?;
                    Some(Point::interval(
                        x,
                        estimate.value,
                        estimate.low,
                        estimate.high,
                    ))
                })
                .collect();
            figure = figure.with(Series::line(self.names(&self.series_axes, &values), points));
        }
        figure
    }

    /// The settings that all series share, and how they were sampled.
    fn note(&self, sampling: &str) -> String {
        let common: Vec<String> = (0..self.axes.len())
            .filter(|&index| self.axes[index].values.len() == 1)
            .map(|index| name(&self.axes[index].name, &self.axes[index].values[0]))
            .collect();
        format!("{}. {sampling}", common.join(", "))
    }

    fn names(&self, axes: &[usize], values: &[String]) -> String {
        let names: Vec<String> = axes
            .iter()
            .zip(values)
            .map(|(&axis, value)| name(&self.axes[axis].name, value))
            .collect();
        names.join(", ")
    }
}

/// The readable name of a setting with a value.
fn name(axis: &str, value: &str) -> String {
    match axis {
        "policy" => value.to_owned(),
        "pilot" => format!("{value} pilot density"),
        "uav_count" => format!("{value} UAVs"),
        "hotspot_count" => format!("{value} hotspots"),
        field => format!("{field} = {value}"),
    }
}

/// How an axis is drawn: its readable name, its unit, and the value of a unit.
#[derive(Debug, PartialEq)]
struct Scale {
    name: String,
    unit: String,
    value: f64,
}

/// The scale of an axis. A frequency has a prefix, so that 5.8e9 Hz is 5.8 GHz.
fn scale(axis: &Axis) -> Scale {
    let (name, unit) = match axis.name.as_str() {
        "uav_count" => ("UAVs", ""),
        "hotspot_count" => ("hotspots", ""),
        field => {
            let infos = &mut Config::FIELDS.iter();
            let unit = infos
                .find(|info| info.name == field)
                .map_or("", |info| info.unit);
            let suffix = format!("_{}", unit.to_lowercase());
            (field.strip_suffix(suffix.as_str()).unwrap_or(field), unit)
        }
    };
    let largest = numbers(axis).into_iter().flatten().fold(0.0, f64::max);
    let (prefix, value) = match unit {
        "Hz" if largest >= 1e9 => ("G", 1e9),
        "Hz" if largest >= 1e6 => ("M", 1e6),
        "Hz" if largest >= 1e3 => ("k", 1e3),
        _ => ("", 1.0),
    };
    Scale {
        name: name.replace('_', " "),
        unit: format!("{prefix}{unit}"),
        value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_names_its_field_without_the_unit() {
        let drawn = |name: &str, values: &[f64]| scale(&Axis::new(name, values));
        let expected = |name: &str, unit: &str, value| Scale {
            name: name.to_owned(),
            unit: unit.to_owned(),
            value,
        };
        assert_eq!(
            drawn("carrier_frequency_hz", &[2.4e9, 5.8e9]),
            expected("carrier frequency", "GHz", 1e9)
        );
        assert_eq!(
            drawn("bandwidth_hz", &[2e7, 1e8]),
            expected("bandwidth", "MHz", 1e6)
        );
        assert_eq!(
            drawn("cell_size_m", &[25.0, 50.0]),
            expected("cell size", "m", 1.0)
        );
        assert_eq!(drawn("uav_count", &[5.0, 10.0]), expected("UAVs", "", 1.0));
    }
}
