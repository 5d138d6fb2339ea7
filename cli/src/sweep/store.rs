//! The table of a sweep on file, so that an interrupted sweep can resume.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use jcas_episode::statistics::{Estimate, Summary};
use serde::{Deserialize, Serialize};

use super::plan::{Axis, SweepCell};
use crate::error::CliError;
use crate::files;
use crate::shard::hash_of_policy;

/// Minimum time between two writes of the file; it is also written at the end.
const WRITE_INTERVAL: Duration = Duration::from_secs(1);

/// What a table holds beside its results.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Frame {
    /// The columns.
    pub columns: Vec<String>,
    /// The fields that identify the cell of each row; they stand in the first columns.
    pub keys: Vec<Vec<String>>,
}

impl Frame {
    /// The frame of a sweep's table.
    ///
    /// # Errors
    /// The file of a policy cannot be read.
    pub fn new(
        axes: &[Axis],
        cells: &[SweepCell],
        seed: u64,
        episodes: u64,
    ) -> Result<Self, CliError> {
        let mut columns: Vec<String> = axes.iter().map(|axis| axis.name.clone()).collect();
        columns.extend(["policy_hash", "config_hash", "seed", "episodes"].map(str::to_owned));
        columns.extend(quantity_columns());
        let mut hashes = BTreeMap::new();
        let mut keys = Vec::with_capacity(cells.len());
        for cell in cells {
            let policy = cell.policy.as_str();
            if !hashes.contains_key(policy) {
                hashes.insert(policy, hash_of_policy(policy)?);
            }
            let mut key = cell.values.clone();
            key.push(hashes[policy].clone());
            key.push(format!("0x{:016x}", cell.config.hash()));
            key.push(seed.to_string());
            key.push(episodes.to_string());
            keys.push(key);
        }
        Ok(Self { columns, keys })
    }

    /// Says in what a row of another sweep differs.
    fn difference(&self, row: &[String]) -> String {
        for (column, value) in row.iter().enumerate().take(self.key_len()) {
            let mut here: Vec<&str> = self.keys.iter().map(|key| key[column].as_str()).collect();
            if !here.contains(&value.as_str()) {
                here.dedup();
                return format!(
                    "holds the results of another sweep: {} is {value} there and {} here",
                    self.columns[column],
                    here.join(", ")
                );
            }
        }
        "holds the results of another sweep: it has a cell that is none here".to_owned()
    }

    fn key_len(&self) -> usize {
        self.keys.first().map_or(self.columns.len(), Vec::len)
    }
}

/// The table and the file that holds it.
pub struct Store {
    path: PathBuf,
    frame: Frame,
    rows: BTreeMap<usize, Vec<String>>,
    written: Instant,
}

impl Store {
    /// Opens the table and reads the rows that an earlier run of the same sweep has written.
    pub fn open(path: &Path, frame: Frame, overwrite: bool) -> Result<Self, CliError> {
        let mut store = Self::empty(path, frame);
        if path.exists() && !overwrite {
            store.read("give another --out, or --overwrite to replace it")?;
        }
        Ok(store)
    }

    /// Opens a table that must have all of its rows.
    pub fn complete(path: &Path, frame: Frame) -> Result<Self, CliError> {
        let mut store = Self::empty(path, frame);
        store.read("run this shard again with --overwrite")?;
        if store.rows.len() < store.frame.keys.len() {
            return Err(CliError::file(
                path,
                format!(
                    "holds {} of the {} cells of its shard: the shard's command goes on from there",
                    store.rows.len(),
                    store.frame.keys.len()
                ),
            ));
        }
        Ok(store)
    }

    /// A table without rows.
    pub fn empty(path: &Path, frame: Frame) -> Self {
        Self {
            path: path.to_owned(),
            frame,
            rows: BTreeMap::new(),
            written: Instant::now(),
        }
    }

    /// Takes over the rows of another table, whose row of index `i` is that of `cells[i]` here.
    pub fn take(&mut self, other: Self, cells: impl IntoIterator<Item = usize>) {
        self.rows
            .extend(cells.into_iter().zip(other.rows.into_values()));
    }

    fn read(&mut self, advice: &str) -> Result<(), CliError> {
        let refuse = |what: &str| CliError::file(&self.path, format!("{what}; {advice}"));
        let key_len = self.frame.key_len();
        let bytes = files::read_bytes(&self.path)?;
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let header = reader
            .headers()
            .map_err(|error| refuse(&error.to_string()))?;
        if header
            .iter()
            .ne(self.frame.columns.iter().map(String::as_str))
        {
            return Err(refuse("holds the table of another sweep: other columns"));
        }
        for record in reader.records() {
            let record = record.map_err(|error| refuse(&error.to_string()))?;
            let row: Vec<String> = record.iter().map(str::to_owned).collect();
            let keys = &mut self.frame.keys.iter().enumerate();
            // Equal values on an axis give equal keys; each row then belongs to a cell of its own.
            let cell = keys
                .find(|(cell, key)| row.starts_with(key) && !self.rows.contains_key(cell))
                .map(|(cell, _)| cell)
                .ok_or_else(|| refuse(&self.frame.difference(&row)))?;
            if row[key_len..]
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
        let mut row = self.frame.keys[cell].clone();
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
        files::write_bytes(&self.path, &self.bytes()?)?;
        self.written = Instant::now();
        Ok(())
    }

    /// The content of the file.
    pub fn bytes(&self) -> Result<Vec<u8>, CliError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let failed = |error: csv::Error| CliError::Io(self.path.clone(), error.into());
        writer.write_record(&self.frame.columns).map_err(failed)?;
        for row in self.rows.values() {
            writer.write_record(row).map_err(failed)?;
        }
        writer
            .into_inner()
            .map_err(|error| CliError::Io(self.path.clone(), error.into_error()))
    }

    /// The result of a cell in one quantity, by its column.
    pub fn estimate(&self, cell: usize, quantity: &str) -> Option<Estimate> {
        let row = self.rows.get(&cell)?;
        let column = self
            .frame
            .columns
            .iter()
            .position(|name| name == quantity)?;
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
