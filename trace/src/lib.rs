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
//!
//! ```
//! use jcas_core::{Cell, Model, Scratch};
//! use jcas_trace::{Arguments, Replay, Workspace, WorkspaceSizes, configuration};
//!
//! let trace = std::fs::read_to_string("../tests/golden/charging_to_full.jsonl")?;
//! let model = Model::new(configuration(&trace).expect("a header"))?;
//! let mut words = vec![0; model.state_words()];
//! let mut scratch = vec![0; Scratch::words_for(&model)];
//! let sizes = WorkspaceSizes::of(&model);
//! let workspace = Workspace {
//!     observations: &mut vec![0.0; sizes.observations],
//!     actions: &mut vec![0.0; sizes.actions],
//!     arguments: Arguments {
//!         cells: &mut vec![Cell { x: 0, y: 0 }; sizes.cells],
//!         charges_uj: &mut vec![0; sizes.uavs],
//!         throughput: &mut vec![0.0; sizes.uavs],
//!         matrix: &mut vec![0; sizes.matrix],
//!     },
//! };
//! let mut replay = Replay::new(&model, &mut words, &mut scratch, workspace);
//! assert!(replay.verify(&trace).is_ok());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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
pub use line::{CHECKSUM, EndLine, Escaped, FORMAT, FORMAT_VERSION, Hashes, HeaderLine, StepLine};
pub use reader::{configuration, hexadecimal};
pub use replay::{Lines, Replay};
pub use workspace::{Arguments, Workspace, WorkspaceSizes};
pub use writer::{Sink, Writer};
