//! Writing a trace line by line.

use std::io::Write;

use jcas_core::hash::Fnv1a;
use serde::Serialize;

use super::error::TraceError;
use super::format::{End, Header, Hex, Step};
use super::host::Host;

/// What separates the bytes under the checksum from the checksum.
pub(super) const CHECKSUM_KEY: &str = ",\"checksum\":";

/// Writes the lines of a trace and keeps the checksum.
pub struct Writer<W: Write> {
    out: W,
    hash: Fnv1a,
}

impl<W: Write> Writer<W> {
    /// Begins a trace.
    ///
    /// # Errors
    /// Where writing fails.
    pub fn new(out: W, header: &Header) -> Result<Self, TraceError> {
        let mut writer = Self {
            out,
            hash: Fnv1a::new(),
        };
        writer.line(header)?;
        Ok(writer)
    }

    /// Adds a step, with what the host supplied to it.
    ///
    /// # Errors
    /// Where writing fails.
    pub fn step(&mut self, step: &Step) -> Result<(), TraceError> {
        self.host(&step.host)?;
        self.line(step)
    }

    /// Ends the trace. The checksum in `end` is replaced by the right one, which is returned.
    ///
    /// # Errors
    /// Where writing fails.
    pub fn end(mut self, mut end: End) -> Result<Hex, TraceError> {
        self.host(&end.host)?;
        let text = json(&end);
        let covered = text.rfind(CHECKSUM_KEY).unwrap_or(text.len());
        self.hash.write(&text.as_bytes()[..covered]);
        end.checksum = Hex(self.hash.finish());
        self.out.write_all(json(&end).as_bytes())?;
        self.out.write_all(b"\n")?;
        self.out.flush()?;
        Ok(end.checksum)
    }

    fn host(&mut self, calls: &[Host]) -> Result<(), TraceError> {
        calls.iter().try_for_each(|call| self.line(call))
    }

    fn line(&mut self, value: &impl Serialize) -> Result<(), TraceError> {
        let mut text = json(value);
        text.push('\n');
        self.hash.write(text.as_bytes());
        self.out.write_all(text.as_bytes())?;
        Ok(())
    }
}

/// Lines hold strings, finite numbers and lists of them, which always have a JSON text.
fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("a line of a trace has a JSON text")
}
