//! A part of a reproduction for another machine, and how the parts become the whole.
//!
//! A reproduction is a sequence of units: a campaign, or a training with all that its policy flies.
//! Shard i of n has every n-th unit. Units that need the same trained policy belong to the shard of
//! the first one. A shard's tables tell the unit of each row. Sorted by units, the rows of all
//! shards are in the order of a single run.

use crate::TABLE;
use crate::comparison::{COMPARISON, ComparedRow};
use crate::flights;
use crate::progress_sink::{Progress, ProgressSink};
use crate::scope::Scope;
use crate::table::{Row, Table};
use jcas_core::hash::Fnv1a;
use jcas_episode::card::{CARD, WEIGHTS};
use jcas_episode::shard::Shard;
use jcas_train::error::TrainError;
use jcas_train::run::NoObserver;
use jcas_train::store::{csv_bytes, write_whole};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Name of the column of units.
const UNIT: &str = "unit";

/// A shard without a unit.
const NOTHING: Shard = Shard {
    number: 0,
    count: 1,
};

/// The path of one of a shard's tables.
fn path_of(shard: Shard, folder: &Path, table: &str) -> PathBuf {
    folder.join(format!("{}-{table}", shard.stem()))
}

/// The paths of a shard's tables of results and of comparisons.
pub fn tables(shard: Shard, folder: &Path) -> [PathBuf; 2] {
    [TABLE, COMPARISON].map(|table| path_of(shard, folder, table))
}

/// Decides which units are flown here.
pub(crate) struct Turns {
    /// Absent: all units are.
    shard: Option<Shard>,
    /// The unit that was last asked for; absent before the first one.
    unit: Option<u64>,
    /// The shards that train policies, by the policies' names.
    trainers: HashMap<String, usize>,
    hash: Fnv1a,
}

impl Turns {
    pub fn new(shard: Option<Shard>, scope: &Scope) -> Result<Turns, TrainError> {
        let mut turns = Turns {
            shard,
            unit: None,
            trainers: HashMap::new(),
            hash: Fnv1a::new(),
        };
        // Given policies count with their content, variations with their units.
        let plain = Scope {
            given: Vec::new(),
            variations: Vec::new(),
            ..scope.clone()
        };
        turns.add(format!("{plain:?}").as_bytes());
        for folder in &scope.given {
            turns.add_policy(folder)?;
        }
        Ok(turns)
    }

    /// The next unit: whether it is flown here. `what` names it. `policy` names a policy that is
    /// trained for it.
    pub fn next(&mut self, what: &dyn std::fmt::Debug, policy: Option<&str>) -> bool {
        let unit = self.units();
        self.unit = Some(unit);
        self.add(format!("{what:?}").as_bytes());
        let count = self.shard.map_or(1, |shard| shard.count);
        let own = (unit % count as u64) as usize + 1;
        let number = match policy {
            Some(name) => *self.trainers.entry(name.to_owned()).or_insert(own),
            None => own,
        };
        self.shard.is_none_or(|shard| shard.number == number)
    }

    /// Whether a unit before trains a policy of this name.
    pub fn is_trained(&self, policy: &str) -> bool {
        self.trainers.contains_key(policy)
    }

    /// Adds what results follow from.
    pub fn add(&mut self, bytes: &[u8]) {
        self.hash.write_u64(bytes.len() as u64);
        self.hash.write(bytes);
    }

    /// Adds the files of a trained policy.
    pub fn add_policy(&mut self, folder: &Path) -> Result<(), TrainError> {
        for path in [CARD, WEIGHTS].map(|name| folder.join(name)) {
            self.add(&std::fs::read(&path).map_err(TrainError::file(&path))?);
        }
        Ok(())
    }

    /// The unit that was last asked for.
    pub fn unit(&self) -> u64 {
        self.unit.unwrap_or_default()
    }

    /// Number of units so far.
    fn units(&self) -> u64 {
        self.unit.map_or(0, |unit| unit + 1)
    }
}

/// What is to be flown in all shards.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outline {
    /// Number of units.
    pub units: u64,
    /// Hash of all that results follow from besides the build.
    pub fingerprint: u64,
}

/// Goes through all units without flying one.
pub fn outline(scope: &Scope, out: &Path) -> Result<Outline, TrainError> {
    let mut table = Table::open_shard(&path_of(NOTHING, out, TABLE))?;
    let (_, turns) = flights::fly_all(scope, out, &mut table, Some(NOTHING), &mut NoObserver)?;
    Ok(Outline {
        units: turns.units(),
        fingerprint: turns.hash.finish(),
    })
}

/// Numbers of rows in a shard's tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RowCounts {
    /// In the table of results.
    pub results: usize,
    /// In the table of comparisons.
    pub comparison: usize,
}

/// Computes what a shard's tables lack; none where it was stopped. Pages are made of the merged
/// tables.
pub fn fly_shard(
    scope: &Scope,
    out: &Path,
    shard: Shard,
    narrator: &mut dyn ProgressSink,
) -> Result<Option<RowCounts>, TrainError> {
    let mut table = Table::open_shard(&path_of(shard, out, TABLE))?;
    let flown = flights::fly_all(scope, out, &mut table, Some(shard), narrator);
    table.write()?;
    if flown?.0 == Progress::Stopped {
        return Ok(None);
    }
    Ok(Some(RowCounts {
        results: table.rows.len(),
        comparison: read::<ComparedRow>(&path_of(shard, out, COMPARISON))?.len(),
    }))
}

/// Joins the tables of all shards into the name and the content of each table of the whole. A shard
/// comes with its folder and its numbers of rows. The whole reproduction has `units` units. A
/// comparison without rows has no table.
pub fn merge(
    shards: &[(Shard, &Path, RowCounts)],
    units: u64,
) -> Result<Vec<(&'static str, Vec<u8>)>, TrainError> {
    let results = |rows: &RowCounts| rows.results;
    let results = of_all(shards, (TABLE, units), results, Row::is_again)?;
    let compared = |rows: &RowCounts| rows.comparison;
    let compared = of_all(shards, (COMPARISON, units), compared, ComparedRow::is_again)?;
    let mut tables = vec![(TABLE, csv_bytes(&results, true, Path::new(TABLE))?)];
    if !compared.is_empty() {
        let bytes = csv_bytes(&compared, true, Path::new(COMPARISON))?;
        tables.push((COMPARISON, bytes));
    }
    Ok(tables)
}

/// The rows of all shards in the order of their units. Two trainings of one mission may both fly a
/// script beside it. Its row stands where the single run has it, with the first of them.
fn of_all<R: DeserializeOwned + PartialEq>(
    shards: &[(Shard, &Path, RowCounts)],
    (table, units): (&str, u64),
    count: fn(&RowCounts) -> usize,
    is_again: fn(&R, &R) -> bool,
) -> Result<Vec<R>, TrainError> {
    let mut all = Vec::new();
    let mut owners = HashMap::new();
    for (shard, folder, counts) in shards {
        let path = path_of(*shard, folder, table);
        let rows = read::<R>(&path)?;
        let wanted = count(counts);
        if rows.len() != wanted {
            let has = rows.len();
            let what = format!("holds {has} rows: must be {wanted}, as its shard has written");
            return Err(TrainError::Format(path, what));
        }
        for (unit, row) in rows {
            if unit >= units {
                let what = format!("{UNIT} = {unit}: must be below {units}");
                return Err(TrainError::Format(path, what));
            }
            let owner = *owners.entry(unit).or_insert(shard.number);
            if owner != shard.number {
                let what = format!("has a row of unit {unit}, which shard {owner} has flown");
                return Err(TrainError::Format(path, what));
            }
            all.push((unit, path.clone(), row));
        }
    }
    all.sort_by_key(|(unit, ..)| *unit);
    let mut kept: Vec<R> = Vec::new();
    for (unit, path, row) in all {
        match kept.iter().find(|other| is_again(other, &row)) {
            None => kept.push(row),
            Some(other) if *other == row => {}
            Some(_) => {
                let what = format!("a row of unit {unit} differs from what another shard flew");
                return Err(TrainError::Format(path, what));
            }
        }
    }
    Ok(kept)
}

/// Reads a shard's table: the unit of each row, and the row. None where the file is not there.
pub(crate) fn read<R: DeserializeOwned>(path: &Path) -> Result<Vec<(u64, R)>, TrainError> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let mut reader = csv::Reader::from_path(path).map_err(TrainError::format(path))?;
    let names = reader.headers().map_err(TrainError::format(path))?.clone();
    // A table without rows has no names either.
    if !names.is_empty() && names.get(0) != Some(UNIT) {
        let what = format!("the first column must be {UNIT}: not the table of a shard");
        return Err(TrainError::Format(path.to_owned(), what));
    }
    let names: csv::StringRecord = names.iter().skip(1).collect();
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(TrainError::format(path))?;
        let unit = record.get(0).unwrap_or_default();
        let unit = unit.parse().map_err(|_| {
            let what = format!("{UNIT} = {unit}: must be a whole number");
            TrainError::Format(path.to_owned(), what)
        })?;
        let row: csv::StringRecord = record.iter().skip(1).collect();
        let row = row.deserialize(Some(&names));
        rows.push((unit, row.map_err(TrainError::format(path))?));
    }
    Ok(rows)
}

/// The content of a shard's table.
pub(crate) fn bytes<R: Serialize>(
    units: &[u64],
    rows: &[R],
    path: &Path,
) -> Result<Vec<u8>, TrainError> {
    let text = csv_bytes(rows, true, path)?;
    let text = String::from_utf8(text).map_err(TrainError::format(path))?;
    let units = units.iter().map(u64::to_string);
    let first = std::iter::once(UNIT.to_owned()).chain(units);
    let lines = first.zip(text.lines());
    let lines: String = lines
        .map(|(unit, line)| format!("{unit},{line}\n"))
        .collect();
    Ok(lines.into_bytes())
}

/// Rows of comparisons on file, in a shard with their units.
pub(crate) struct Comparisons {
    path: PathBuf,
    units: Option<Vec<u64>>,
    pub rows: Vec<ComparedRow>,
}

impl Comparisons {
    /// The whole table, or that of a shard.
    pub fn open(out: &Path, shard: Option<Shard>) -> Result<Comparisons, TrainError> {
        let Some(shard) = shard else {
            return Ok(Comparisons {
                path: out.join(COMPARISON),
                units: None,
                rows: crate::comparison::open(out)?,
            });
        };
        let path = path_of(shard, out, COMPARISON);
        let (units, rows) = read(&path)?.into_iter().unzip();
        Ok(Comparisons {
            path,
            units: Some(units),
            rows,
        })
    }

    /// Adds the rows of a unit and writes the file.
    pub fn add(&mut self, unit: u64, rows: Vec<ComparedRow>) -> Result<(), TrainError> {
        if let Some(units) = &mut self.units {
            units.extend(rows.iter().map(|_| unit));
        }
        self.rows.extend(rows);
        let bytes = match &self.units {
            None => csv_bytes(&self.rows, true, &self.path)?,
            Some(units) => bytes(units, &self.rows, &self.path)?,
        };
        write_whole(&self.path, &bytes)
    }
}
