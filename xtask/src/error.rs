//! What can go wrong in a task.

use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};

use displaydoc::Display;
use jcas_ledger::LedgerError;

/// The reason why a task cannot do what it was asked to do.
#[derive(Debug, Display, thiserror::Error)]
pub enum Error {
    /// {0}
    Usage(&'static str),
    /// {option}: there are {allowed}
    UnknownOption {
        /// The option that was given.
        option: String,
        /// The known options.
        allowed: &'static str,
    },
    /// {option} needs {value} after it
    NoValue {
        /// The option.
        option: String,
        /// What it needs.
        value: &'static str,
    },
    /// no option {0}: prove knows --changed
    ProveOption(String),
    /// tidy takes no argument, and {0:?} is given
    TidyArgument(String),
    /// --target {triple}: there are {allowed}
    UnknownTarget {
        /// The triple that was given.
        triple: String,
        /// The known triples.
        allowed: String,
    },
    /// HOME is not set
    NoHome,
    /// {path}: {source}
    File {
        /// The file or folder.
        path: PathBuf,
        /// Why it could not be read or written.
        source: io::Error,
    },
    /// {program} does not start: {source}
    Start {
        /// The program.
        program: String,
        /// Why not.
        source: io::Error,
    },
    #[displaydoc(
        "{program} does not start: {source}; `bash .ci/run install dist` installs what a \
         distribution needs"
    )]
    /// A program that a distribution needs does not start.
    StartDist {
        /// The program.
        program: String,
        /// Why not.
        source: io::Error,
    },
    /// {command} failed: {status}
    Failed {
        /// The command with its arguments.
        command: String,
        /// How it ended.
        status: ExitStatus,
    },
    /// {0}
    Wait(io::Error),
    /// cannot stop {command}: {source}
    Stop {
        /// The command with its arguments.
        command: String,
        /// Why not.
        source: io::Error,
    },
    /// {0}
    Printed(String),
    /// the unit does not build
    UnitBuild,
    /// the FMU: {0}
    Unit(Box<dyn std::error::Error>),
    /// Node: {0}
    Node(io::Error),
    /// {0}
    Archive(Box<dyn std::error::Error>),
    /// the kernel does not build for {0}
    KernelBuild(&'static str),
    /// the library of {0} is absent: `rustup target add {0}` installs it
    NoTargetLibrary(&'static str),
    /// cargo metadata: {source}; {printed}
    Metadata {
        /// What is wrong with its output.
        source: serde_json::Error,
        /// What it printed as errors.
        printed: String,
    },
    /// the time of the commit, {text:?}: {source}
    CommitTime {
        /// The text.
        text: String,
        /// What is wrong with it.
        source: std::num::ParseIntError,
    },
    /// {0}
    Ledger(#[from] LedgerError),
    /// Kani's export is broken: {0}
    Export(serde_json::Error),
    /// {file}: {places} places instead of 1 read `{find}`
    Places {
        /// The file of a mutant.
        file: String,
        /// How often the text occurs there.
        places: usize,
        /// The text that the mutant replaces.
        find: String,
    },
    /// Cargo.toml: no line begins with `members = [`
    NoMembers,
}

impl Error {
    /// For `map_err` after an operation on a file or folder.
    pub fn file(path: &Path) -> impl Fn(io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::File {
            path: path.clone(),
            source,
        }
    }

    /// For `map_err` after the start of a program.
    pub fn start(program: &str) -> impl FnOnce(io::Error) -> Self + use<> {
        let program = program.to_owned();
        move |source| Self::Start { program, source }
    }

    /// A command that ended with a failure.
    pub fn failed(command: &Command, status: ExitStatus) -> Self {
        let command = format!("{command:?}");
        Self::Failed { command, status }
    }
}
