//! What can go wrong around training. Each variant's text names the field or file, its value and
//! what is allowed.

use jcas_episode::card::CardError;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A run that cannot begin, go on or be written.
#[derive(Debug, Error)]
pub enum TrainError {
    /// A setting, a configuration or a combination of them.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// A file could not be read or written.
    #[error("{path}: {1}", path = .0.display())]
    File(PathBuf, #[source] std::io::Error),
    /// A file does not hold what it should.
    #[error("{path}: {1}", path = .0.display())]
    Format(PathBuf, #[source] FormatError),
    /// A folder that holds a run already.
    #[error(
        "{}: holds a run already; continue it with --resume or give another folder",
        .0.display()
    )]
    Taken(PathBuf),
    /// A policy whose network is not that of the settings.
    #[error("{}: its network is {stored}, that of the settings is {own}", folder.display())]
    Network {
        /// Folder of the policy.
        folder: PathBuf,
        /// Its architecture.
        stored: String,
        /// The architecture of the settings.
        own: String,
    },
    /// A policy that scales its inputs, which no training does.
    #[error("{}: it scales its inputs, which no training does", .0.display())]
    ScaledInputs(PathBuf),
    /// A policy that does not fit the mission.
    #[error("{0}")]
    Fit(String),
}

/// A setting that no run can have.
#[derive(Debug, Error)]
pub enum SettingError {
    /// A value that is out of its range or does not fit another setting.
    #[error("{setting}: {value} is not allowed, it must be {allowed}")]
    Value {
        /// Name of the setting.
        setting: &'static str,
        /// Its value.
        value: String,
        /// What is allowed.
        allowed: String,
    },
    /// A name in a group of settings that is none.
    #[error("{group}.{name}: there is no such name, allowed: {allowed}")]
    Name {
        /// The group.
        group: &'static str,
        /// The name.
        name: String,
        /// The names that are allowed.
        allowed: String,
    },
    /// Overrides that are no values of their fields.
    #[error("config_overrides: {0}")]
    Overrides(#[from] serde_json::Error),
    /// A configuration that the kernel refuses, with the overrides.
    #[error("config_overrides: {0}")]
    Configuration(#[source] jcas_core::Error),
    /// A configuration that the kernel refuses as given.
    #[error(transparent)]
    Model(#[from] jcas_core::Error),
    /// Episodes of the evaluation that cannot be run.
    #[error("{0}")]
    Evaluation(String),
}

impl SettingError {
    /// A value out of its range.
    pub fn value(
        setting: &'static str,
        value: impl ToString,
        allowed: impl Into<String>,
    ) -> SettingError {
        SettingError::Value {
            setting,
            value: value.to_string(),
            allowed: allowed.into(),
        }
    }
}

/// Content of a file that does not belong there.
#[derive(Debug, Error)]
pub enum FormatError {
    /// No safetensors file.
    #[error(transparent)]
    Safetensors(#[from] safetensors::SafeTensorError),
    /// A text that is no JSON of its type.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// A row that is no CSV.
    #[error(transparent)]
    Csv(#[from] csv::Error),
    /// CSV that could not be written.
    #[error("{0}")]
    CsvWriter(String),
    /// A text that is not UTF-8.
    #[error(transparent)]
    Text(#[from] std::string::FromUtf8Error),
    /// An array that is missing.
    #[error("array {0:?} is missing")]
    Missing(String),
    /// An array of another type.
    #[error("array {name:?} is of {got}, allowed: {allowed}")]
    Type {
        /// Name of the array.
        name: String,
        /// Its type.
        got: String,
        /// The types that are allowed.
        allowed: &'static str,
    },
    /// An array of another length.
    #[error("array {name:?} has {got} entries, expected {expected}")]
    Length {
        /// Name of the array.
        name: String,
        /// Its entries.
        got: usize,
        /// The entries that the network has.
        expected: usize,
    },
    /// A checkpoint without its note.
    #[error("the metadata entry \"jcas\" is missing")]
    NoNote,
    /// A checkpoint of another version.
    #[error("checkpoint format {got}, this version reads {expected}")]
    Version {
        /// Its format.
        got: u32,
        /// The present format.
        expected: u32,
    },
    /// A checkpoint of another run.
    #[error(
        "belongs to a run with other settings; to go on, give the same ones:\n{stored}\nnow \
         given:\n{given}"
    )]
    OtherRun {
        /// The run that it belongs to.
        stored: String,
        /// The run that asks for it.
        given: String,
    },
    /// A checkpoint of another number of workers.
    #[error("workers: the checkpoint has {stored}, this run {given}")]
    Workers {
        /// Workers of the checkpoint.
        stored: usize,
        /// Workers of the run.
        given: usize,
    },
    /// States of another length.
    #[error("environment state: {got} bytes, this run needs {expected}")]
    States {
        /// Bytes of the file.
        got: usize,
        /// Bytes of the run's episodes.
        expected: usize,
    },
    /// A state that the kernel refuses.
    #[error(transparent)]
    State(#[from] jcas_core::Error),
    /// An architecture that no network has.
    #[error("architecture: {0}")]
    Architecture(#[source] serde_json::Error),
    /// Input statistics of a network that has none.
    #[error("normalised_inputs: only an MLP has input statistics")]
    Inputs,
    /// A card that cannot be read.
    #[error("{0}")]
    Card(String),
}

impl From<CardError> for TrainError {
    fn from(error: CardError) -> TrainError {
        match error {
            CardError::File(path, error) => TrainError::File(path, error),
            CardError::Format(path, what) => TrainError::Format(path, FormatError::Card(what)),
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
    pub fn format<E: Into<FormatError>>(path: &Path) -> impl FnOnce(E) -> TrainError {
        let path = path.to_owned();
        move |error| TrainError::Format(path, error.into())
    }
}
