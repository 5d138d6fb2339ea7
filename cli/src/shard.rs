//! Parts of a long computation for several machines, and what merging checks of every part.

use core::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use displaydoc::Display;
use jcas_core::hash::Fnv1a;
use jcas_episode::card::{CARD, WEIGHTS};
use jcas_episode::files::{WEIGHTS_BYTES_MAX, read};
use jcas_episode::shard::Shard;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::error::CliError;
use crate::{files, learned, planned};

/// Number of missing parts that a message names.
const MISSING_SHOWN: usize = 20;

/// The executable that ran a part.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Build {
    /// Version of the kernel.
    kernel: String,
    /// Hash of the executable, since two sources may have one version.
    executable: String,
}

impl Build {
    /// The executable that runs.
    ///
    /// # Errors
    /// Its file cannot be read.
    pub fn current() -> Result<Self, CliError> {
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

/// The fields that every manifest has.
#[derive(Clone, Copy, Debug)]
pub struct Head<'m> {
    /// The version of the format that the manifest states.
    pub format: u32,
    /// The build that computes the part.
    pub build: &'m Build,
    /// The part.
    pub shard: Shard,
}

/// The reason why bytes are no manifest of a part.
#[derive(Debug, Display, thiserror::Error)]
pub enum ManifestError {
    /// {0}
    Json(#[from] serde_json::Error),
    /// format = {format}: must be {needed}
    Format {
        /// The version that the manifest states.
        format: u32,
        /// The version that this program reads.
        needed: u32,
    },
    /// shard = {0}: must be i/n, 1 <= i <= n
    Shard(Shard),
    /// it has {count} episodes: must be {needed}, shard {shard} of {all}
    Episodes {
        /// The episodes of the manifest.
        count: usize,
        /// The episodes of the part.
        needed: usize,
        /// The part.
        shard: Shard,
        /// The episodes of all parts.
        all: usize,
    },
    /// it has {count} keys: must be {needed}, shard {shard} of {all} cells
    Keys {
        /// The keys of the manifest.
        count: usize,
        /// The cells of the part.
        needed: usize,
        /// The part.
        shard: Shard,
        /// The cells of all parts.
        all: usize,
    },
    /// a key is longer than the columns
    LongKey,
}

/// What the manifests of all computations have in common.
pub trait Manifest: Serialize + DeserializeOwned {
    /// What the manifest describes, such as `a sweep's shard`.
    const DESCRIBES: &'static str;
    /// Version of the format.
    const FORMAT: u32;

    /// The fields that every manifest has.
    fn head(&self) -> Head<'_>;

    /// The part.
    fn shard(&self) -> Shard {
        self.head().shard
    }

    /// Checks what else the manifest says of its part.
    ///
    /// # Errors
    /// The part does not have what the manifest says.
    fn check(&self) -> Result<(), ManifestError> {
        Ok(())
    }

    /// Refuses a part of another computation, of another split or by another build.
    ///
    /// # Errors
    /// The field that differs.
    fn require_same(&self, path: &Path, origin: &str, other: &Self) -> Result<(), CliError> {
        let (own, others) = (self.head(), other.head());
        require_equal(
            path,
            origin,
            "other build: kernel",
            (own.build, others.build),
        )?;
        self.require_same_work(path, origin, other)?;
        let count = (&own.shard.count, &others.shard.count);
        require_equal(path, origin, "number of shards", count)
    }

    /// Refuses a part of another computation.
    ///
    /// # Errors
    /// The field that differs.
    fn require_same_work(&self, path: &Path, origin: &str, other: &Self) -> Result<(), CliError>;

    /// Reads a manifest and checks that it describes the part that it names.
    ///
    /// # Errors
    /// The file cannot be read, or is no such manifest.
    fn read(path: &Path) -> Result<Self, CliError> {
        let bytes = files::read_bytes(path)?;
        Self::parse(&bytes).map_err(|error| {
            let what = format!("is no manifest of {}: {error}", Self::DESCRIBES);
            CliError::file(path, what)
        })
    }

    /// Parses a manifest and checks that it describes the part that it names.
    ///
    /// # Errors
    /// The bytes are no such manifest.
    fn parse(bytes: &[u8]) -> Result<Self, ManifestError> {
        let manifest: Self = serde_json::from_slice(bytes)?;
        let Head { format, shard, .. } = manifest.head();
        if format != Self::FORMAT {
            let needed = Self::FORMAT;
            return Err(ManifestError::Format { format, needed });
        }
        if !shard.is_valid() {
            return Err(ManifestError::Shard(shard));
        }
        manifest.check()?;
        Ok(manifest)
    }

    /// Writes the manifest.
    ///
    /// # Errors
    /// The file cannot be written.
    fn write(&self, path: &Path) -> Result<(), CliError> {
        let mut text = serde_json::to_vec_pretty(self).map_err(CliError::input)?;
        text.push(b'\n');
        files::write_bytes(path, &text)
    }
}

/// Hash of the files of a trained policy or a plan; the text is empty for a baseline, which has
/// none.
///
/// # Errors
/// A file cannot be read.
pub fn hash_of_policy(policy: &str) -> Result<String, CliError> {
    let files = files_of(policy);
    if files.is_empty() {
        return Ok(String::new());
    }
    let mut hash = Fnv1a::new();
    for path in files {
        let bytes = read(&path, WEIGHTS_BYTES_MAX).map_err(CliError::io(&path))?;
        hash.write_u64(bytes.len() as u64);
        hash.write(&bytes);
    }
    Ok(format!("0x{:016x}", hash.finish()))
}

/// The files that hold a policy.
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

/// Refuses two parts that differ in a field.
///
/// # Errors
/// The field differs.
pub fn require_equal<T: PartialEq + fmt::Display>(
    path: &Path,
    origin: &str,
    field: &str,
    (own, others): (&T, &T),
) -> Result<(), CliError> {
    if own == others {
        return Ok(());
    }
    let what = format!("{field} = {own}: must be {others}, as in {origin}");
    Err(CliError::file(path, what))
}

/// Refuses to replace a table with another content, unless that is asked for.
///
/// # Errors
/// The file has another content, or cannot be read.
pub fn require_replaceable(path: &Path, bytes: &[u8], overwrite: bool) -> Result<(), CliError> {
    if overwrite || !path.exists() || files::read_bytes(path)? == bytes {
        return Ok(());
    }
    let what = "holds another table; give another place, or --overwrite to replace it";
    Err(CliError::file(path, what))
}

/// The manifests of all parts in the order of their numbers, every number once. `out` is what they
/// are merged into.
///
/// # Errors
/// A part is missing, given twice, of another computation or by another build.
pub fn read_all<'a, M: Manifest>(
    paths: &'a [PathBuf],
    out: &Path,
) -> Result<Vec<(&'a PathBuf, M)>, CliError> {
    let mut parts: Vec<(&PathBuf, M)> = Vec::new();
    for path in paths {
        let part = M::read(path)?;
        if let Some((first_path, first)) = parts.first() {
            part.require_same(path, &first_path.display().to_string(), first)?;
        }
        parts.push((path, part));
    }
    parts.sort_by_key(|(_, part)| part.shard().number);
    for pair in parts.windows(2) {
        let [(path, part), (other_path, other)] = pair else {
            continue;
        };
        if part.shard() == other.shard() {
            return Err(CliError::input(format!(
                "{} and {}: both are shard {}; give each shard once",
                path.display(),
                other_path.display(),
                part.shard()
            )));
        }
    }
    require_every_number(&parts, out)?;
    Ok(parts)
}

fn require_every_number<M: Manifest>(parts: &[(&PathBuf, M)], out: &Path) -> Result<(), CliError> {
    let Some((_, first)) = parts.first() else {
        return Err(CliError::input("no shard is given; must be at least one"));
    };
    let count = first.shard().count;
    let given = |number: &usize| {
        let mut numbers = parts.iter().map(|(_, part)| part.shard().number);
        numbers.any(|own| own == *number)
    };
    let missing: Vec<String> = (1..=count)
        .filter(|number| !given(number))
        .take(MISSING_SHOWN)
        .map(|number| format!("shard-{number}-of-{count}.json"))
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    let names: Vec<String> = parts
        .iter()
        .map(|(path, _)| path.display().to_string())
        .collect();
    Err(CliError::input(format!(
        "{}: missing {}; all {count} shards are needed, given {}",
        out.display(),
        missing.join(", "),
        names.join(", ")
    )))
}
