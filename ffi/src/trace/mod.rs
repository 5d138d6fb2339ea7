//! Traces through the C interface: lines written from states into the caller's sink, and read back to be flown
//! again. The format is that of `jcas trace`.

mod host;
mod line;
mod number;
mod reader;
mod recording;
mod verify;

pub(crate) use host::Host;
pub(crate) use reader::Refusal;
pub(crate) use recording::{Recording, Sink, Workspace};
pub(crate) use verify::{configuration, verify};
