//! The table of a sweep on file, so that an interrupted sweep can resume.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use jcas_episode::statistics::{Estimate, Summary};

use super::plan::{Axis, Cell};
use crate::error::CliError;
use crate::files;

/// Minimum time between two writes of the file; it is also written at the end.
const WRITE_INTERVAL: Duration = Duration::from_secs(1);

/// The table and the file that holds it.
pub struct Store {
    path: PathBuf,
    header: Vec<String>,
    /// Columns that identify the cell of a row.
    key_len: usize,
    keys: Vec<Vec<String>>,
    rows: BTreeMap<usize, Vec<String>>,
    written: Instant,
}

impl Store {
    /// Opens the table and reads the rows that an earlier run of the same sweep has written.
    pub fn open(
        path: &Path,
        axes: &[Axis],
        cells: &[Cell],
        seed: u64,
        episodes: u64,
        overwrite: bool,
    ) -> Result<Self, CliError> {
        let mut header: Vec<String> = axes.iter().map(|axis| axis.name.clone()).collect();
        header.extend(["config_hash", "seed", "episodes"].map(str::to_owned));
        let key_len = header.len();
        header.extend(quantity_columns());
        let keys = cells
            .iter()
            .map(|cell| {
                let mut key = cell.values.clone();
                key.push(format!("0x{:016x}", cell.config.hash()));
                key.push(seed.to_string());
                key.push(episodes.to_string());
                key
            })
            .collect();
        let mut store = Self {
            path: path.to_owned(),
            header,
            key_len,
            keys,
            rows: BTreeMap::new(),
            written: Instant::now(),
        };
        if path.exists() && !overwrite {
            store.read()?;
        }
        Ok(store)
    }

    fn read(&mut self) -> Result<(), CliError> {
        let refuse = |what: &str| {
            CliError::file(
                &self.path,
                format!("{what}; give another --out, or --overwrite to replace it"),
            )
        };
        let bytes = std::fs::read(&self.path).map_err(CliError::io(&self.path))?;
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let header = reader
            .headers()
            .map_err(|error| refuse(&error.to_string()))?;
        if header.iter().ne(self.header.iter().map(String::as_str)) {
            return Err(refuse("holds the table of another sweep: other columns"));
        }
        for record in reader.records() {
            let record = record.map_err(|error| refuse(&error.to_string()))?;
            let row: Vec<String> = record.iter().map(str::to_owned).collect();
            let cell = self
                .keys
                .iter()
                .position(|key| row.starts_with(key))
                .ok_or_else(|| {
                    refuse(&format!(
                        "holds a row of another sweep: {}",
                        row[..self.key_len].join(",")
                    ))
                })?;
            if row[self.key_len..]
                .iter()
                .any(|text| text.parse::<f64>().is_err())
            {
                return Err(refuse(&format!(
                    "row {}: not a number",
                    self.rows.len() + 1
                )));
            }
            self.rows.insert(cell, row);
        }
        Ok(())
    }

    /// The path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether a cell is on file.
    pub fn has(&self, cell: usize) -> bool {
        self.rows.contains_key(&cell)
    }

    /// Number of cells on file.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Adds the results of a cell.
    pub fn add(&mut self, cell: usize, summary: &Summary) -> Result<(), CliError> {
        let mut row = self.keys[cell].clone();
        for quantity in summary.quantities() {
            let Estimate { value, low, high } = quantity.estimate;
            // This is the shortest text that parses to the same number.
            row.extend([value, low, high].map(|number| number.to_string()));
        }
        self.rows.insert(cell, row);
        if self.written.elapsed() >= WRITE_INTERVAL {
            self.write()?;
        }
        Ok(())
    }

    /// Writes the file.
    pub fn write(&mut self) -> Result<(), CliError> {
        files::write_atomically(&self.path, |out| {
            let mut writer = csv::Writer::from_writer(out);
            let failed = |error: csv::Error| CliError::Io(self.path.clone(), error.into());
            writer.write_record(&self.header).map_err(failed)?;
            for row in self.rows.values() {
                writer.write_record(row).map_err(failed)?;
            }
            writer.flush().map_err(CliError::io(&self.path))
        })?;
        self.written = Instant::now();
        Ok(())
    }

    /// The result of a cell in one quantity, by its column.
    pub fn estimate(&self, cell: usize, quantity: &str) -> Option<Estimate> {
        let row = self.rows.get(&cell)?;
        let column = self.header.iter().position(|name| name == quantity)?;
        let number = |offset: usize| row.get(column + offset)?.parse().ok();
        Some(Estimate {
            value: number(0)?,
            low: number(1)?,
            high: number(2)?,
        })
    }
}

fn quantity_columns() -> Vec<String> {
    Summary::of(&[], 0)
        .quantities()
        .iter()
        .flat_map(|quantity| ["", "_low", "_high"].map(|end| format!("{}{end}", quantity.name)))
        .collect()
}
