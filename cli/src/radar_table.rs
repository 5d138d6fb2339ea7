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
    line: u64,
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
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(text.as_bytes());
        let refused = |problem: String| CliError::file(path, problem);
        let names = reader
            .headers()
            .map_err(|error| refused(error.to_string()))?;
        let column = |name| names.iter().position(|of| of == name);
        let (Some(range), Some(probability)) = (column(RANGE), column(PROBABILITY)) else {
            let names: Vec<_> = names.iter().collect();
            return Err(refused(format!(
                "line 1: must name the columns {RANGE} and {PROBABILITY}; it is \"{}\"",
                names.join(",")
            )));
        };
        let density = column(DENSITY);
        let mut rows = Vec::new();
        for row in reader.records() {
            let row = row.map_err(|error| refused(error.to_string()))?;
            let line = row.position().map_or(0, |begin| line_of(&text, begin));
            let number = |name, column| {
                let text = row.get(column).unwrap_or("");
                text.parse().map_err(|_| {
                    refused(format!(
                        "line {line}: {name} = \"{text}\": must be a number"
                    ))
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
        let points: Vec<_> = rows.iter().map(|row| row.point).collect();
        let Some(table) = DetectionTable::from_slice(&points) else {
            return Err(self.refused(
                rows[MAX_DETECTION_POINTS].line,
                format!("must be one of at most {MAX_DETECTION_POINTS} points of a table"),
            ));
        };
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

    fn refused(&self, line: u64, problem: impl core::fmt::Display) -> CliError {
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

/// The line of a record. Its position is that of the empty lines before it, if there are some.
fn line_of(text: &str, begin: &csv::Position) -> u64 {
    let rest = text.bytes().skip(begin.byte() as usize);
    let empty = rest.take_while(|byte| matches!(byte, b'\r' | b'\n'));
    begin.line() + empty.filter(|&byte| byte == b'\n').count() as u64
}
