//! Traces: an episode written down so that any build can be held to it, bit for bit.
//!
//! A trace is a text file of JSON lines: one `header`, one `step` for each step, one `end`. It
//! holds the configuration, the seed and every action. [`verify`] therefore flies the episode again
//! without its policy, and compares every field of every line. Real numbers are compared as bits:
//! they have as many digits as it takes to read back the same number. [`diff`] compares two files.
//!
//! Each call of a host simulator is a line of its own, before the step that it is part of. Its
//! `kind` is the call's name ([`Host`]).
//!
//! Sets are ascending lists of indices. `observation_hash` is FNV-1a, 64 bits, over the
//! little-endian bytes of all observations (f32), and `state_hash` over those of the kernel's state.
//! `checksum` in the last line is the same hash over all bytes that come before `,"checksum"`.
//!
//! Nothing here needs threads or the file system, so that traces are checked on any target.

mod compare;
mod error;
mod format;
mod host;
mod read;
mod record;

pub use compare::{Difference, diff};
pub use error::TraceError;
pub use format::{End, FORMAT, Header, Hex, Initial, Rewards, Step, Trace};
pub use host::Host;
pub use jcas_trace::FORMAT_VERSION;
pub use read::read;
pub use record::{EpisodeRecorder, record, verify};
