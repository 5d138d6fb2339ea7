//! A part of a sweep for another machine, and what merging needs to know about the part.

use std::fs;
use std::path::{Path, PathBuf};

use jcas_core::hash::Fnv1a;
use jcas_episode::shard::Shard;
use serde::{Deserialize, Serialize};

use super::plan::SweepCell;
use super::store::{Frame, Store};
use crate::error::CliError;
use crate::shard::{Build, Head, Manifest, ManifestError, require_equal};

/// Opens the table of a part and returns its cells. The manifest is on file before the first cell
/// runs, so that rows of another build are not continued.
pub fn open(
    shard: Shard,
    folder: &Path,
    cells: Vec<SweepCell>,
    frame: Frame,
    overwrite: bool,
) -> Result<(Vec<SweepCell>, Store), CliError> {
    let manifest = SweepManifest::new(shard, &frame)?;
    let path = shard.manifest_path(folder);
    let table = table_of(&path);
    if overwrite {
        remove(&table)?;
    } else if path.exists() {
        let earlier = SweepManifest::read(&path)?;
        let origin = "this command; give another --out, or --overwrite to replace it";
        earlier.require_same(&path, origin, &manifest)?;
    } else if table.exists() {
        let what = "has no manifest; give another --out, or --overwrite to replace it";
        return Err(CliError::file(&table, what));
    }
    manifest.write(&path)?;
    let store = Store::open(&table, manifest.frame, false)?;
    let own = cells.into_iter().skip(shard.number - 1);
    Ok((own.step_by(shard.count).collect(), store))
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

/// What merging must know of a part. It stands beside the part's table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepManifest {
    format: u32,
    build: Build,
    /// Hash of everything that the results follow from: columns, cells, seed, episodes, policies.
    sweep: String,
    shard: Shard,
    /// Number of cells of all parts.
    pub cells_in_all: usize,
    /// Columns and keys of the part's table.
    pub frame: Frame,
}

impl SweepManifest {
    fn new(shard: Shard, frame: &Frame) -> Result<Self, CliError> {
        let key = |cell: usize| frame.keys[cell].clone();
        Ok(Self {
            format: Self::FORMAT,
            build: Build::current()?,
            sweep: fingerprint(frame),
            shard,
            cells_in_all: frame.keys.len(),
            frame: Frame {
                columns: frame.columns.clone(),
                keys: shard.cells(frame.keys.len()).map(key).collect(),
            },
        })
    }
}

impl Manifest for SweepManifest {
    const DESCRIBES: &'static str = "a sweep's shard";
    const FORMAT: u32 = 1;

    fn head(&self) -> Head<'_> {
        Head {
            format: self.format,
            build: &self.build,
            shard: self.shard,
        }
    }

    fn check(&self) -> Result<(), ManifestError> {
        let Frame { columns, keys } = &self.frame;
        let (shard, count, all) = (self.shard, keys.len(), self.cells_in_all);
        let needed = shard.cell_count(all);
        if count != needed {
            return Err(ManifestError::Keys {
                count,
                needed,
                shard,
                all,
            });
        }
        if keys.iter().any(|key| key.len() > columns.len()) {
            return Err(ManifestError::LongKey);
        }
        Ok(())
    }

    fn require_same_work(&self, path: &Path, origin: &str, other: &Self) -> Result<(), CliError> {
        let sweep = (&self.sweep, &other.sweep);
        require_equal(path, origin, "other sweep: fingerprint", sweep)?;
        let cells = (&self.cells_in_all, &other.cells_in_all);
        require_equal(path, origin, "other sweep: number of cells", cells)?;
        let columns = [self, other].map(|part| part.frame.columns.join(","));
        require_equal(path, origin, "columns", (&columns[0], &columns[1]))
    }
}

/// Hash of what a sweep's results follow from: the columns and the keys. The keys have the hashes
/// of each policy and configuration, the seed and the number of episodes.
fn fingerprint(frame: &Frame) -> String {
    let mut hash = Fnv1a::new();
    for text in frame.columns.iter().chain(frame.keys.iter().flatten()) {
        hash.write_u64(text.len() as u64);
        hash.write(text.as_bytes());
    }
    format!("0x{:016x}", hash.finish())
}
