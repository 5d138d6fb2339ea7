//! Paths of this machine, and how they stay out of what is built.

use crate::error::Error;
use std::path::{Path, PathBuf};

/// Options of the compiler that keep the paths of this machine out of what it writes. The folder
/// is the one that Cargo builds in.
pub fn without_paths(folder: &Path) -> Result<Vec<String>, Error> {
    let home = std::env::var_os("HOME").ok_or(Error::NoHome)?;
    let cargo = std::env::var_os("CARGO_HOME")
        .map_or_else(|| Path::new(&home).join(".cargo"), PathBuf::from);
    // The last that fits counts.
    let here = absolute(Path::new("."))?;
    let names = [
        (here.as_path(), "/jcas"),
        (folder, "/target"),
        (&cargo, "/cargo"),
    ];
    Ok(names
        .map(|(path, name)| format!("--remap-path-prefix={}={name}", path.display()))
        .into())
}

/// The path from the root of the file system.
pub fn absolute(path: &Path) -> Result<PathBuf, Error> {
    std::path::absolute(path).map_err(Error::file(path))
}
