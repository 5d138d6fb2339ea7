//! The writer of a trace, which passes lines to a sink and adds a checksum to the last one.

use core::fmt::{self, Display, Write};

use jcas_core::hash::Fnv1a;

use crate::line::CHECKSUM;

/// A sink for the bytes of a trace in their order.
pub trait Sink {
    /// The reason why bytes are refused.
    type Error;

    /// Takes some bytes.
    ///
    /// # Errors
    /// The call fails if the sink cannot take the bytes. The writer then stops writing.
    fn take(&mut self, bytes: &[u8]) -> Result<(), Self::Error>;
}

/// Writes the lines of a trace to a sink and keeps their checksum.
#[derive(Debug)]
pub struct Writer<S: Sink> {
    sink: S,
    hash: Fnv1a,
    refused: Option<S::Error>,
}

impl<S: Sink> Writer<S> {
    /// Builds a writer before the first line.
    #[must_use]
    pub fn new(sink: S) -> Self {
        Self {
            sink,
            hash: Fnv1a::new(),
            refused: None,
        }
    }

    /// Writes a line. A refusal of the sink is kept for [`Writer::check`] and [`Writer::finish`].
    pub fn line(&mut self, line: &dyn Display) {
        let mut pipe = Pipe {
            writer: self,
            buffer: [0; 1024],
            filled: 0,
        };
        // Formatting into the pipe never fails.
        let _always = write!(pipe, "{line}");
        pipe.flush();
    }

    /// The refusal of the sink, if there was one.
    ///
    /// # Errors
    /// The error is that of the sink when it refused bytes.
    pub fn check(&mut self) -> Result<(), S::Error> {
        self.refused.take().map_or(Ok(()), Err)
    }

    /// Adds the checksum after the end line and returns it.
    ///
    /// # Errors
    /// The error is that of the sink when it refused bytes, now or before.
    pub fn finish(mut self) -> Result<u64, S::Error> {
        let hash = self.hash.finish();
        self.line(&format_args!("{CHECKSUM}{hash:016x}\"}}\n"));
        self.check().map(|()| hash)
    }
}

/// A buffer that gathers text into larger pieces for the sink.
struct Pipe<'w, S: Sink> {
    writer: &'w mut Writer<S>,
    buffer: [u8; 1024],
    filled: usize,
}

impl<S: Sink> Pipe<'_, S> {
    fn flush(&mut self) {
        let bytes = &self.buffer[..self.filled];
        self.writer.hash.write(bytes);
        if self.writer.refused.is_none() && !bytes.is_empty() {
            self.writer.refused = self.writer.sink.take(bytes).err();
        }
        self.filled = 0;
    }
}

impl<S: Sink> Write for Pipe<'_, S> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let mut rest = text.as_bytes();
        while !rest.is_empty() {
            if self.filled == self.buffer.len() {
                self.flush();
            }
            let (now, later) = rest.split_at(rest.len().min(self.buffer.len() - self.filled));
            self.buffer[self.filled..self.filled + now.len()].copy_from_slice(now);
            self.filled += now.len();
            rest = later;
        }
        Ok(())
    }
}
