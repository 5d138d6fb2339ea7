//! Errors of commands, and the exit code of each.

use core::fmt;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use jcas_episode::campaign::FlightError;
use jcas_episode::trace::TraceError;
use jcas_policy::PolicyError;

use crate::files;

/// The outcome of a command that did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The command did what it was asked to do.
    Done,
    /// A verification or comparison found a difference.
    Different,
}

/// The reason why a command failed.
#[derive(Debug)]
pub enum CliError {
    /// An input is not acceptable; the message names it.
    Input(String),
    /// A file could not be read or written.
    Io(PathBuf, std::io::Error),
    /// Ctrl-C stopped the command; the message says how to resume.
    Interrupted(String),
}

/// Explanation of the exit codes, for `--help`.
pub const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    a verification or comparison found a difference
  2    an input is not acceptable: an option, a field, or the content of a file
  3    a file could not be read or written
  130  stopped by Ctrl-C";

const EXIT_DIFFERENT: u8 = 1;
const EXIT_INPUT: u8 = 2;
const EXIT_IO: u8 = 3;
const EXIT_INTERRUPTED: u8 = 130;

/// Returns the exit code of a result; prints an error on standard error.
pub fn exit_code(result: Result<Outcome, CliError>) -> ExitCode {
    match result {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Different) => ExitCode::from(EXIT_DIFFERENT),
        Err(error) => {
            eprintln!("error: {}", files::lines(&error.to_string()));
            error.exit_code()
        }
    }
}

impl CliError {
    /// Builds the error of an unacceptable input.
    pub fn input(message: impl fmt::Display) -> Self {
        Self::Input(message.to_string())
    }

    /// Builds the error of an unacceptable file.
    pub fn file(path: &Path, message: impl fmt::Display) -> Self {
        Self::Input(format!("{}: {message}", path.display()))
    }

    /// Builds the error of a file operation, for `map_err`.
    pub fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |error| Self::Io(path, error)
    }

    /// Builds the error of a trace file.
    pub fn trace(path: &Path, error: TraceError) -> Self {
        match error {
            TraceError::Io(error) => Self::Io(path.to_owned(), error),
            other => Self::file(path, other),
        }
    }

    /// The exit code of the error.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Input(_) => EXIT_INPUT,
            Self::Io(..) => EXIT_IO,
            Self::Interrupted(_) => EXIT_INTERRUPTED,
        })
    }
}

impl fmt::Display for CliError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(message) | Self::Interrupted(message) => out.write_str(message),
            Self::Io(path, error) => write!(out, "{}: {error}", path.display()),
        }
    }
}

impl std::error::Error for CliError {}

impl From<jcas_core::Error> for CliError {
    fn from(error: jcas_core::Error) -> Self {
        Self::input(error)
    }
}

impl From<PolicyError<'_>> for CliError {
    fn from(error: PolicyError<'_>) -> Self {
        Self::input(error)
    }
}

impl From<FlightError> for CliError {
    fn from(error: FlightError) -> Self {
        match error {
            FlightError::Stopped => Self::Interrupted("interrupted".to_owned()),
            refused @ FlightError::Kernel { .. } => Self::input(refused),
        }
    }
}
