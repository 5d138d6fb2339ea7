//! A part of a sweep for another machine, and what merging needs to know about the part.

use core::fmt;
use core::str::FromStr;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use jcas_core::hash::Fnv1a;
use jcas_episode::card::{CARD, WEIGHTS};
use serde::{Deserialize, Serialize};

use super::plan::SweepCell;
use super::store::{Frame, Store};
use crate::error::CliError;
use crate::{files, learned, planned};

/// Version of the manifest's format.
const FORMAT: u32 = 1;

/// The i-th of n parts, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// i.
    pub number: usize,
    /// n.
    pub count: usize,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        text.split_once('/')
            .and_then(|(number, count)| {
                Some(Self {
                    number: number.parse().ok()?,
                    count: count.parse().ok()?,
                })
            })
            .filter(Shard::is_valid)
            .ok_or_else(|| "must be i/n with 1 <= i <= n, such as 2/8".to_owned())
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}/{}", self.number, self.count)
    }
}

impl Shard {
    fn is_valid(&self) -> bool {
        (1..=self.count).contains(&self.number)
    }

    /// The indices of its cells: every n-th, since neighbours in the grid cost alike.
    pub fn cells(&self, cells_in_all: usize) -> impl Iterator<Item = usize> + use<> {
        (self.number - 1..cells_in_all).step_by(self.count)
    }

    /// The path of its table.
    fn table_path(&self, folder: &Path) -> PathBuf {
        table_of(&self.manifest_path(folder))
    }

    /// The path of its manifest.
    pub fn manifest_path(&self, folder: &Path) -> PathBuf {
        folder.join(format!("shard-{}-of-{}.json", self.number, self.count))
    }

    /// Opens the table of this part and returns its cells. The manifest is on file before the first
    /// cell runs, so that rows of another build are not continued.
    pub fn open(
        self,
        folder: &Path,
        cells: Vec<SweepCell>,
        frame: Frame,
        overwrite: bool,
    ) -> Result<(Vec<SweepCell>, Store), CliError> {
        let manifest = Manifest::new(self, &cells, &frame)?;
        let (table, path) = (self.table_path(folder), self.manifest_path(folder));
        if overwrite {
            remove(&table)?;
        } else if path.exists() {
            let earlier = Manifest::read(&path)?;
            let origin = "this command; give another --out, or --overwrite to replace it";
            earlier.require_same(&path, origin, &manifest)?;
        } else if table.exists() {
            let what = "has no manifest; give another --out, or --overwrite to replace it";
            return Err(CliError::file(&table, what));
        }
        let mut text = serde_json::to_vec_pretty(&manifest).map_err(CliError::input)?;
        text.push(b'\n');
        files::write_bytes(&path, &text)?;
        let store = Store::open(&table, manifest.frame, false)?;
        let own = cells.into_iter().skip(self.number - 1).step_by(self.count);
        Ok((own.collect(), store))
    }
}

/// The table beside a manifest.
pub fn table_of(manifest: &Path) -> PathBuf {
    manifest.with_extension("csv")
}

fn remove(path: &Path) -> Result<(), CliError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(CliError::io(path)(error))
        }
        _ => Ok(()),
    }
}

/// The executable that ran a part.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Build {
    /// Version of the kernel.
    kernel: String,
    /// Hash of the executable, since two sources may have one version.
    executable: String,
}

impl Build {
    fn current() -> Result<Self, CliError> {
        let path = std::env::current_exe().map_err(CliError::io(Path::new("jcas")))?;
        let mut hash = Fnv1a::new();
        hash.write(&fs::read(&path).map_err(CliError::io(&path))?);
        Ok(Self {
            kernel: jcas_core::VERSION.to_owned(),
            executable: format!("0x{:016x}", hash.finish()),
        })
    }
}

impl fmt::Display for Build {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} with executable {}", self.kernel, self.executable)
    }
}

/// What merging must know of a part. It stands beside the part's table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    format: u32,
    build: Build,
    /// Hash of everything that the results follow from: columns, cells, seed, episodes, policies.
    sweep: String,
    /// The part.
    pub shard: Shard,
    /// Number of cells of all parts.
    pub cells_in_all: usize,
    /// Columns and keys of the part's table.
    pub frame: Frame,
}

impl Manifest {
    fn new(shard: Shard, cells: &[SweepCell], frame: &Frame) -> Result<Self, CliError> {
        let key = |cell: usize| frame.keys[cell].clone();
        Ok(Self {
            format: FORMAT,
            build: Build::current()?,
            sweep: fingerprint(cells, frame)?,
            shard,
            cells_in_all: cells.len(),
            frame: Frame {
                columns: frame.columns.clone(),
                keys: shard.cells(cells.len()).map(key).collect(),
            },
        })
    }

    /// Reads a manifest and checks that it describes the part that it names.
    pub fn read(path: &Path) -> Result<Self, CliError> {
        let bytes = fs::read(path).map_err(CliError::io(path))?;
        let refuse = |what: &dyn fmt::Display| {
            CliError::file(path, format!("is no manifest of a shard: {what}"))
        };
        let manifest: Self = serde_json::from_slice(&bytes).map_err(|error| refuse(&error))?;
        let Self { format, shard, .. } = manifest;
        if format != FORMAT {
            return Err(refuse(&format!("format = {format}: must be {FORMAT}")));
        }
        if !shard.is_valid() {
            return Err(refuse(&format!(
                "shard = {shard}: must be i/n, 1 <= i <= n"
            )));
        }
        let Frame { columns, keys } = &manifest.frame;
        let (rows, all) = (keys.len(), manifest.cells_in_all);
        let own = shard.cells(all).count();
        if rows != own {
            let what = format!("it has {rows} keys: must be {own}, shard {shard} of {all} cells");
            return Err(refuse(&what));
        }
        if keys.iter().any(|key| key.len() > columns.len()) {
            return Err(refuse(&"a key is longer than the columns"));
        }
        Ok(manifest)
    }

    /// Refuses a part of another sweep, of another split or by another build.
    pub fn require_same(&self, path: &Path, origin: &str, other: &Self) -> Result<(), CliError> {
        let differs = |field: &str, own: &dyn fmt::Display, others: &dyn fmt::Display| {
            let what = format!("{field} = {own}: must be {others}, as in {origin}");
            Err(CliError::file(path, what))
        };
        if self.build != other.build {
            return differs("other build: kernel", &self.build, &other.build);
        }
        let (own, others) = (&self.sweep, &other.sweep);
        if own != others || self.cells_in_all != other.cells_in_all {
            return differs("other sweep: fingerprint", own, others);
        }
        let (own, others) = (&self.frame.columns, &other.frame.columns);
        if own != others {
            return differs("columns", &own.join(","), &others.join(","));
        }
        if self.shard.count != other.shard.count {
            return differs("number of shards", &self.shard.count, &other.shard.count);
        }
        Ok(())
    }
}

/// Hash of what a sweep's results follow from. The keys have the hash of each configuration, the
/// seed and the number of episodes; a policy on file counts with its bytes.
fn fingerprint(cells: &[SweepCell], frame: &Frame) -> Result<String, CliError> {
    let mut hash = Fnv1a::new();
    let mut add = |bytes: &[u8]| {
        hash.write_u64(bytes.len() as u64);
        hash.write(bytes);
    };
    for text in frame.columns.iter().chain(frame.keys.iter().flatten()) {
        add(text.as_bytes());
    }
    let policies: BTreeSet<&str> = cells.iter().map(|cell| cell.policy.as_str()).collect();
    for policy in policies {
        for path in files_of(policy) {
            add(&fs::read(&path).map_err(CliError::io(&path))?);
        }
    }
    Ok(format!("0x{:016x}", hash.finish()))
}

/// The files that hold a policy; a baseline has none.
fn files_of(policy: &str) -> Vec<PathBuf> {
    if learned::is_policy(policy) {
        return [CARD, WEIGHTS]
            .map(|name| Path::new(policy).join(name))
            .into();
    }
    planned::file_of(policy)
        .map(Path::to_owned)
        .into_iter()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_hold_every_cell_once() {
        for count in 1..=8 {
            let parts = (1..=count).map(|number| Shard { number, count });
            let mut cells: Vec<usize> = parts.flat_map(|part| part.cells(5)).collect();
            cells.sort_unstable();
            assert_eq!(cells, [0, 1, 2, 3, 4], "{count}");
        }
        let second: Vec<usize> = Shard {
            number: 2,
            count: 3,
        }
        .cells(8)
        .collect();
        assert_eq!(second, [1, 4, 7]);
    }

    #[test]
    fn a_part_counts_from_one_to_the_number_of_parts() {
        assert_eq!(
            "3/3".parse(),
            Ok(Shard {
                number: 3,
                count: 3
            })
        );
        for text in ["0/3", "4/3", "0/0", "1", "1/", "/2", "-1/2", "1/2/3", "a/b"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
