//! Traces: text files of episodes, which any build can reproduce and compare bit for bit.
//!
//! A file has one `header` line, one `step` line for each step and one `end` line, each a JSON
//! object. Each call of a host simulator is a line of its own, before the step that it is part of.
//! The format is documented in `jcas-episode`, which reads traces into structures.
//!
//! - [`Writer`] passes lines to a [`Sink`] and adds the checksum.
//! - [`HeaderLine`], [`StepLine`], [`EndLine`] and [`CallLine`] display a line.
//! - [`Replay`] repeats an episode from its seed, its actions and its calls. It writes each line
//!   again and compares it with the file, byte by byte.
//!
//! Nothing here allocates: the caller supplies a state, working memory and a [`Workspace`].
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

mod call;
mod error;
mod line;
mod number;
mod reader;
mod replay;
mod workspace;
mod writer;

pub use call::CallLine;
pub use error::{Problem, VerifyError};
pub use line::{EndLine, Escaped, FORMAT_VERSION, Hashes, HeaderLine, StepLine};
pub use reader::configuration;
pub use replay::{Lines, Replay};
pub use workspace::{Arguments, Workspace, WorkspaceSizes};
pub use writer::{Sink, Writer};
