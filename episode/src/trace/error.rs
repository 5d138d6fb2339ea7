//! Errors of traces.

use core::fmt;

use jcas_core::Printable;
use jcas_trace::{FORMAT, FORMAT_VERSION};

use super::format::Hex;

/// The reason why a trace cannot be recorded, read or replayed.
#[derive(Debug)]
#[non_exhaustive]
pub enum TraceError {
    /// Reading or writing failed.
    Io(std::io::Error),
    /// The file has no line.
    Empty,
    /// The first line is no header of this format.
    NotATrace(String),
    /// The trace has another version of the format.
    Version(u64),
    /// A line does not follow the format.
    Malformed {
        /// Number of the line, from 1.
        line: usize,
        /// The fault of the line.
        problem: String,
    },
    /// The file ends before its last line.
    Truncated {
        /// Number of complete steps in the file.
        steps: usize,
    },
    /// Lines follow the end line.
    Trailing {
        /// Number of the first surplus line.
        line: usize,
    },
    /// The content was changed after it was written.
    Checksum {
        /// The checksum in the file.
        stated: Hex,
        /// The checksum of the file's bytes.
        computed: Hex,
    },
    /// The kernel refused the configuration or an action.
    Kernel(jcas_core::Error),
}

impl fmt::Display for TraceError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => error.fmt(out),
            Self::Empty => out.write_str("the trace is empty: must begin with a header line"),
            Self::NotATrace(problem) => {
                write!(
                    out,
                    "line 1: {}: must be the header of a {FORMAT} file",
                    Printable(problem)
                )
            }
            Self::Version(found) => {
                write!(out, "format_version = {found}: must be {FORMAT_VERSION}")
            }
            Self::Malformed { line, problem } => {
                write!(out, "line {line}: {}", Printable(problem))
            }
            Self::Truncated { steps } => write!(
                out,
                "the trace is truncated: it stops after {steps} whole steps, without its end line"
            ),
            Self::Trailing { line } => write!(
                out,
                "line {line}: the end line must be the last of the file"
            ),
            Self::Checksum { stated, computed } => write!(
                out,
                "checksum = {stated}: the content gives {computed}, \
                 so it was changed after recording"
            ),
            Self::Kernel(error) => error.fmt(out),
        }
    }
}

impl std::error::Error for TraceError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Io(error) => Some(error),
            Self::Kernel(error) => Some(error),
            _ => None,
        }
    }
}

impl From<std::io::Error> for TraceError {
    fn from(error: std::io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<jcas_core::Error> for TraceError {
    fn from(error: jcas_core::Error) -> Self {
        Self::Kernel(error)
    }
}
