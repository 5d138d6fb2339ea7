//! Why a trace cannot be used.

use core::fmt;

use jcas_trace::FORMAT_VERSION;

use super::format::{FORMAT, Hex};

/// Why a trace cannot be recorded, read or flown again.
#[derive(Debug)]
#[non_exhaustive]
pub enum TraceError {
    /// Reading or writing failed.
    Io(std::io::Error),
    /// There is no line at all.
    Empty,
    /// The first line is no header of this format.
    NotATrace(String),
    /// Written in another version of the format.
    Version(u64),
    /// A line is not what the format says.
    Malformed {
        /// 1 for the first line.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// The file stops before its last line.
    Truncated {
        /// Whole steps that it holds.
        steps: usize,
    },
    /// Lines follow the last one.
    Trailing {
        /// The first line too many.
        line: usize,
    },
    /// The content was changed after it was written.
    Checksum {
        /// What the file says.
        stated: Hex,
        /// What its bytes give.
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
                    "line 1: {problem}: must be the header of a {FORMAT} file"
                )
            }
            Self::Version(found) => write!(
                out,
                "format_version = {found}: this build reads versions 1 to {FORMAT_VERSION}"
            ),
            Self::Malformed { line, problem } => write!(out, "line {line}: {problem}"),
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
                "checksum = {stated}: the content gives {computed}, so it was changed after recording"
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
