//! What can go wrong around training.

use jcas_episode::card::CardError;
use std::path::{Path, PathBuf};

/// Names what was wrong, where, and what is allowed.
#[derive(Debug)]
pub enum TrainError {
    /// A setting, a configuration or a combination of them.
    Setting(String),
    /// A file could not be read or written.
    File(PathBuf, std::io::Error),
    /// A file does not hold what it should.
    Format(PathBuf, String),
    /// A policy does not fit the mission.
    Fit(String),
}

impl std::fmt::Display for TrainError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            TrainError::Setting(what) | TrainError::Fit(what) => f.write_str(what),
            TrainError::File(path, error) => write!(f, "{}: {error}", path.display()),
            TrainError::Format(path, what) => write!(f, "{}: {what}", path.display()),
        }
    }
}

impl std::error::Error for TrainError {}

impl From<CardError> for TrainError {
    fn from(error: CardError) -> TrainError {
        match error {
            CardError::File(path, error) => TrainError::File(path, error),
            CardError::Format(path, what) => TrainError::Format(path, what),
            CardError::Fit(what) => TrainError::Fit(what),
        }
    }
}

impl TrainError {
    /// For `map_err` after file operations on `path`.
    pub fn file(path: &Path) -> impl FnOnce(std::io::Error) -> TrainError {
        let path = path.to_owned();
        move |error| TrainError::File(path, error)
    }

    /// For `map_err` after reading the content of `path`.
    pub fn format<E: std::fmt::Display>(path: &Path) -> impl FnOnce(E) -> TrainError {
        let path = path.to_owned();
        move |error| TrainError::Format(path, error.to_string())
    }
}
