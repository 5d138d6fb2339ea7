//! What can go wrong with the ledger.

use std::io;
use std::path::{Path, PathBuf};

use displaydoc::Display;

/// The reason why the ledger cannot be read, written or selected from.
#[derive(Debug, Display, thiserror::Error)]
pub enum LedgerError {
    /// {path}: {source}
    File {
        /// The file or folder.
        path: PathBuf,
        /// Why it could not be read or written.
        source: io::Error,
    },
    /// {path}: {source}
    Toml {
        /// The file.
        path: PathBuf,
        /// What is wrong with its text.
        source: toml::de::Error,
    },
    /// {0}
    Text(#[from] toml::ser::Error),
    /// no proof is called `{0}` in verification/proofs.toml
    UnknownProof(String),
}

impl LedgerError {
    /// For `map_err` after an operation on a file or folder.
    pub(crate) fn file(path: &Path) -> impl Fn(io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::File {
            path: path.clone(),
            source,
        }
    }

    /// For `map_err` after reading the text of a file.
    pub(crate) fn toml(path: PathBuf) -> impl FnOnce(toml::de::Error) -> Self {
        move |source| Self::Toml { path, source }
    }
}
