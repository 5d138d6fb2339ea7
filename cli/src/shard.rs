//! Parts of a long computation for several machines, and what merging checks of every part.

use core::fmt;
use core::str::FromStr;
use std::fs;
use std::path::{Path, PathBuf};

use jcas_core::hash::Fnv1a;
use serde::{Deserialize, Serialize};

use crate::error::CliError;
use crate::files;

/// Number of missing parts that a message names.
const MISSING_SHOWN: usize = 20;

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
    /// Whether 1 ≤ i ≤ n.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        (1..=self.count).contains(&self.number)
    }

    /// The indices of its cells: every n-th, since neighbours in the grid cost alike.
    pub fn cells(&self, cells_in_all: usize) -> impl Iterator<Item = usize> + use<> {
        (self.number - 1..cells_in_all).step_by(self.count)
    }

    /// The path of its manifest.
    #[must_use]
    pub fn manifest_path(&self, folder: &Path) -> PathBuf {
        folder.join(format!("shard-{}-of-{}.json", self.number, self.count))
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

/// What the manifests of all computations have in common.
pub trait Manifest: Serialize + Sized {
    /// Reads a manifest and checks that it describes the part that it names.
    ///
    /// # Errors
    /// The file cannot be read, or is no such manifest.
    fn read(path: &Path) -> Result<Self, CliError>;

    /// The part.
    fn shard(&self) -> Shard;

    /// Refuses a part of another computation, of another split or by another build.
    ///
    /// # Errors
    /// The field that differs.
    fn require_same(&self, path: &Path, origin: &str, other: &Self) -> Result<(), CliError>;

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
