//! Detection tables in CSV files: a range and P_d a line, at one or several pilot densities.

use std::path::{Path, PathBuf};

use jcas_core::config::{DetectionPoint, DetectionTable, MAX_DETECTION_POINTS};
use jcas_core::error::Value;
use jcas_core::{Config, DetectionCurve};

use crate::error::CliError;
use crate::files;

const RANGE: &str = "range_m";
const PROBABILITY: &str = "p_d";
const DENSITY: &str = "pilot_density";

/// The rows of a file. What they hold is checked where a table is made of them.
pub struct RadarTable {
    path: PathBuf,
    rows: Vec<RadarRow>,
}

/// A line of the file.
struct RadarRow {
    line: u32,
    /// The pilot density; absent if the file has no such column.
    density: Option<f64>,
    point: DetectionPoint,
}

impl RadarTable {
    /// Reads the columns `range_m`, `p_d` and, if there is one, `pilot_density`.
    ///
    /// # Errors
    /// The file cannot be read, a column is missing, or a value is no number.
    pub fn read(path: &Path) -> Result<Self, CliError> {
        let text = files::read_text(path)?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let mut lines = (1..).zip(text.lines());
        let names = lines.next().map_or("", |(_, names)| names);
        let column = |name| values(names).position(|of| of == name);
        let (Some(range), Some(probability)) = (column(RANGE), column(PROBABILITY)) else {
            return Err(CliError::file(
                path,
                format!(
                    "line 1: must name the columns {RANGE} and {PROBABILITY}; it is \"{names}\""
                ),
            ));
        };
        let density = column(DENSITY);
        let mut rows = Vec::new();
        for (line, row) in lines.filter(|(_, row)| !row.trim().is_empty()) {
            let number = |name, column| {
                let text = values(row).nth(column).unwrap_or("");
                text.parse().map_err(|_| {
                    CliError::file(
                        path,
                        format!("line {line}: {name} = \"{text}\": must be a number"),
                    )
                })
            };
            rows.push(RadarRow {
                line,
                density: density.map(|at| number(DENSITY, at)).transpose()?,
                point: (number(RANGE, range)?, number(PROBABILITY, probability)?).into(),
            });
        }
        Ok(Self {
            path: path.to_owned(),
            rows,
        })
    }

    /// The rows at the highest pilot density as a checked table. A file without densities is taken
    /// to be measured at the highest.
    ///
    /// # Errors
    /// No row has this density, there are too many, or they are no legal table.
    pub fn at_density_max(&self, density_max: f64) -> Result<DetectionTable, CliError> {
        let rows: Vec<_> = self
            .rows
            .iter()
            .filter(|row| row.holds(density_max))
            .collect();
        if rows.is_empty() {
            let found: Vec<_> = self.densities().iter().map(f64::to_string).collect();
            return Err(CliError::file(
                &self.path,
                match found.is_empty() {
                    true => "must have a line of numbers below the names".to_owned(),
                    false => format!(
                        "must have lines with {DENSITY} = {density_max}, the configured \
                         pilot_density_max; it has {}",
                        found.join(", ")
                    ),
                },
            ));
        }
        if let Some(row) = rows.get(MAX_DETECTION_POINTS) {
            return Err(self.refused(
                row.line,
                format!("must be one of at most {MAX_DETECTION_POINTS} points of a table"),
            ));
        }
        let points: Vec<_> = rows.iter().map(|row| row.point).collect();
        let table = DetectionTable::from_slice(&points).unwrap_or(DetectionTable::EMPTY);
        let config = Config {
            detection_curve: DetectionCurve::Table,
            detection_table: table,
            ..Config::default()
        };
        config.validate().map_err(|error| match error.value {
            Value::Pair(range_m, probability) => {
                let bad = [range_m.to_bits(), probability.to_bits()];
                let line = rows.iter().rev().find(|row| row.bits() == bad);
                self.refused(line.map_or(0, |row| row.line), error)
            }
            _ => CliError::file(&self.path, error),
        })?;
        Ok(table)
    }

    /// The pilot densities of the file, the highest first; none if it has no such column.
    pub fn densities(&self) -> Vec<f64> {
        let mut densities: Vec<_> = self.rows.iter().filter_map(|row| row.density).collect();
        densities.sort_by(|a, b| b.total_cmp(a));
        densities.dedup();
        densities
    }

    /// The points at a pilot density, as they are in the file.
    pub fn points(&self, density: f64) -> impl Iterator<Item = DetectionPoint> {
        let rows = self.rows.iter().filter(move |row| row.holds(density));
        rows.map(|row| row.point)
    }

    fn refused(&self, line: u32, problem: impl core::fmt::Display) -> CliError {
        CliError::file(&self.path, format!("line {line}: {problem}"))
    }
}

impl RadarRow {
    fn holds(&self, density: f64) -> bool {
        self.density.is_none_or(|of| of == density)
    }

    fn bits(&self) -> [u64; 2] {
        [
            self.point.range_m.to_bits(),
            self.point.probability.to_bits(),
        ]
    }
}

/// The values of a line, without the quotes that some programs put around them.
fn values(line: &str) -> impl Iterator<Item = &str> {
    line.split(',').map(|value| value.trim().trim_matches('"'))
}
