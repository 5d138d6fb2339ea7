//! The errors of replays.

use core::error::Error as StdError;
use core::fmt;

use jcas_core::config::text::TextError;
use jcas_core::{Error, Printable};

/// The reason why a trace is not reproduced, and its line.
#[derive(Clone, Debug, PartialEq)]
pub struct VerifyError<'t> {
    /// The line number, from 1; 0 means the whole file.
    pub line: usize,
    /// The problem in that line.
    pub problem: Problem<'t>,
}

/// A problem of a trace.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Problem<'t> {
    /// The file has no last line, or its checksum does not fit.
    Incomplete,
    /// A line is not in the form that this crate writes.
    Form,
    /// The simulation has another configuration.
    OtherModel,
    /// The kernel refuses an action or a call of the host.
    Kernel(Error),
    /// The configuration is not legal.
    Config(TextError),
    /// The line differs from that of the replay, first in this field.
    Differs(&'t str),
    /// The caller's memory has the wrong size.
    Memory,
}

impl fmt::Display for VerifyError<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line > 0 {
            write!(out, "line {}: ", self.line)?;
        }
        self.problem.fmt(out)
    }
}

impl fmt::Display for Problem<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Incomplete => {
                out.write_str("not a whole trace: must end with a checksum that fits")
            }
            Self::Form => out.write_str("not as jcas writes traces"),
            Self::OtherModel => out.write_str("the simulation has another configuration"),
            Self::Kernel(error) => error.fmt(out),
            Self::Config(error) => error.fmt(out),
            Self::Differs(field) => {
                write!(out, "{} differs from the replay", Printable(field))
            }
            Self::Memory => out.write_str("a fault of the library itself"),
        }
    }
}

impl StdError for VerifyError<'_> {}
