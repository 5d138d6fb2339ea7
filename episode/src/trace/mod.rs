//! Traces: recorded episodes that any build has to reproduce bit for bit.
//!
//! A trace is a text file of JSON lines: one `header`, one `step` for each step, one `end`. It
//! holds the configuration, the seed and every action. [`verify`] therefore replays the episode
//! without its policy, and compares every field of every line. Real numbers are compared as bits:
//! each has enough digits to read back the same number. [`diff`] compares two files.
//!
//! Each call of a host simulator is a separate line before its step. Its `kind` is the call's name
//! ([`Host`]).
//!
//! Sets are ascending lists of indices. `observation_hash` is FNV-1a, 64 bits, over the
//! little-endian bytes of all observations (f32). `state_hash` is the same hash over those of the
//! kernel's state. `checksum` in the last line is the same hash over all bytes that come before
//! `,"checksum"`.
//!
//! The crate `jcas-trace` writes the text and repeats it. A [`Trace`] keeps the text as it is, and
//! is a view of what its lines say.
//!
//! This module needs neither threads nor the file system, so that traces are checked on any target.

mod compare;
mod error;
mod format;
mod host;
mod read;
mod record;

pub use compare::{Difference, diff};
pub use error::TraceError;
pub use format::{End, Header, Hex, Initial, Rewards, Step, Trace};
pub use host::Host;
pub use jcas_trace::{CHECKSUM, FORMAT, FORMAT_VERSION};
pub use read::read;
pub use record::{EpisodeRecorder, record, rerecord, verify};
