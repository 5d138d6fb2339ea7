//! A trace read as jcas writes it, line by line and without an allocation; why one is refused.

use std::fmt;
use std::str::FromStr;

use jcas_core::config::text::TextError;
use jcas_core::{Cell, Config, Error};

use super::line::FORMAT_VERSION;
use crate::status::{
    Fault, JCAS_ERROR_CORRUPT, JCAS_ERROR_DIFFERENT, JCAS_ERROR_INTERNAL, JCAS_ERROR_MODEL_MISMATCH,
};

/// Why a trace is not reproduced, at which line of the file; 0 for the whole of it.
pub(crate) struct Refusal<'t> {
    line: usize,
    why: Why<'t>,
}

/// What is wrong.
pub(crate) enum Why<'t> {
    Whole,
    Form,
    Model,
    Kernel(Error),
    Config(TextError),
    Differs(&'t str),
    Internal,
}

impl Refusal<'_> {
    pub(super) const WHOLE: Self = Self {
        line: 0,
        why: Why::Whole,
    };

    pub(crate) fn status(&self) -> Fault {
        Fault::Status(match self.why {
            Why::Whole | Why::Form | Why::Kernel(_) | Why::Config(_) => JCAS_ERROR_CORRUPT,
            Why::Model => JCAS_ERROR_MODEL_MISMATCH,
            Why::Differs(_) => JCAS_ERROR_DIFFERENT,
            Why::Internal => JCAS_ERROR_INTERNAL,
        })
    }
}

impl fmt::Display for Refusal<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line > 0 {
            write!(out, "line {}: ", self.line)?;
        }
        match &self.why {
            Why::Whole => out.write_str("not a whole trace: must end with a checksum that fits"),
            Why::Form => out.write_str("not as jcas writes traces"),
            Why::Model => out.write_str("the simulation has another configuration"),
            Why::Kernel(error) => error.fmt(out),
            Why::Config(error) => error.fmt(out),
            Why::Differs(field) => write!(out, "{field} differs from what is flown"),
            Why::Internal => out.write_str("a fault of the library itself"),
        }
    }
}

/// Sixteen digits.
pub(super) fn hexadecimal(digits: &str) -> Option<u64> {
    let legal = digits.len() == 16
        && digits
            .bytes()
            .all(|digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f'));
    legal
        .then(|| u64::from_str_radix(digits, 16).ok())
        .flatten()
}

/// The first line, as far as it is not for comparison alone.
pub(super) struct Told<'t> {
    pub(super) version: u32,
    pub(super) core_version: &'t str,
    pub(super) config: Config,
    pub(super) seed: u64,
    pub(super) policy: &'t str,
    pub(super) pilot: &'t str,
    pub(super) line: &'t str,
}

/// A place in a trace.
#[derive(Clone)]
pub(super) struct Reader<'t> {
    /// This line, whole.
    pub(super) line: &'t str,
    /// What of it is still to be read.
    pub(super) rest: &'t str,
    /// The lines after it.
    pub(super) later: &'t str,
    number: usize,
}

impl<'t> Reader<'t> {
    pub(super) fn new(trace: &'t str) -> Self {
        let mut reader = Self {
            line: "",
            rest: "",
            later: trace,
            number: 0,
        };
        reader.next_line();
        reader
    }

    pub(super) fn next_line(&mut self) {
        let end = self.later.find('\n').map_or(self.later.len(), |at| at + 1);
        let (line, later) = self.later.split_at(end);
        self.line = line;
        self.rest = line;
        self.later = later;
        self.number += 1;
    }

    pub(super) fn refuse(&self, why: Why<'t>) -> Refusal<'t> {
        Refusal {
            line: self.number,
            why,
        }
    }

    pub(super) fn skip(&mut self, text: &str) -> Result<(), Why<'t>> {
        self.rest = self.rest.strip_prefix(text).ok_or(Why::Form)?;
        Ok(())
    }

    /// Up to a character, which stays.
    fn until(&mut self, stop: impl Fn(char) -> bool) -> Result<&'t str, Why<'t>> {
        let at = self.rest.find(stop).ok_or(Why::Form)?;
        let (text, rest) = self.rest.split_at(at);
        self.rest = rest;
        Ok(text)
    }

    pub(super) fn number<T: FromStr>(&mut self) -> Result<T, Why<'t>> {
        let digits = |c: char| !matches!(c, '0'..='9' | '-' | '+' | '.' | 'e');
        self.until(digits)?.parse().map_err(|_| Why::Form)
    }

    /// What stands between quotes, with its escapes.
    pub(super) fn text(&mut self) -> Result<&'t str, Why<'t>> {
        let mut escaped = false;
        let at = self.rest.find(|c| {
            let ends = c == '"' && !escaped;
            escaped = c == '\\' && !escaped;
            ends
        });
        let (text, rest) = self.rest.split_at(at.ok_or(Why::Form)?);
        self.rest = rest;
        Ok(text)
    }

    fn hex(&mut self) -> Result<u64, Why<'t>> {
        let (digits, rest) = self.rest.split_at_checked(16).ok_or(Why::Form)?;
        self.rest = rest;
        hexadecimal(digits).ok_or(Why::Form)
    }

    /// `[..]`: calls `each` before every element with its index.
    pub(super) fn list(
        &mut self,
        mut each: impl FnMut(&mut Self, usize) -> Result<(), Why<'t>>,
    ) -> Result<usize, Why<'t>> {
        self.skip("[")?;
        let mut count = 0;
        while !self.rest.starts_with(']') {
            if count > 0 {
                self.skip(",")?;
            }
            each(self, count)?;
            count += 1;
        }
        self.skip("]")?;
        Ok(count)
    }

    /// As many elements as `out` has, or fewer; how many.
    pub(super) fn fill<T>(
        &mut self,
        out: &mut [T],
        mut read: impl FnMut(&mut Self) -> Result<T, Why<'t>>,
    ) -> Result<usize, Why<'t>> {
        self.list(|reader, index| {
            *out.get_mut(index).ok_or(Why::Form)? = read(reader)?;
            Ok(())
        })
    }

    pub(super) fn pair<T: FromStr>(&mut self) -> Result<[T; 2], Why<'t>> {
        self.skip("[")?;
        let first = self.number()?;
        self.skip(",")?;
        let second = self.number()?;
        self.skip("]")?;
        Ok([first, second])
    }

    pub(super) fn cell(&mut self) -> Result<Cell, Why<'t>> {
        let [x, y] = self.pair()?;
        Ok(Cell { x, y })
    }

    pub(super) fn header(&mut self) -> Result<Told<'t>, Refusal<'t>> {
        self.told().map_err(|why| self.refuse(why))
    }

    fn told(&mut self) -> Result<Told<'t>, Why<'t>> {
        self.skip("{\"kind\":\"header\",\"format\":\"jcas-trace\",\"format_version\":")?;
        let version = self.number()?;
        if !(1..=FORMAT_VERSION).contains(&version) {
            return Err(Why::Form);
        }
        self.skip(",\"core_version\":\"")?;
        let core_version = self.text()?;
        self.skip("\",\"config\":")?;
        let text = self.rest;
        let braced = self.until(|c| c == '}')?.len() + 1;
        let config = Config::from_json(&text[..braced]).map_err(Why::Config)?;
        self.skip("},\"config_hash\":\"0x")?;
        self.hex()?;
        self.skip("\",\"seed\":\"0x")?;
        let seed = self.hex()?;
        self.skip("\",\"policy\":\"")?;
        let policy = self.text()?;
        self.skip("\",\"pilot\":\"")?;
        let pilot = self.text()?;
        Ok(Told {
            version,
            core_version,
            config,
            seed,
            policy,
            pilot,
            line: self.line,
        })
    }

    /// The actions of the next step in the file, from this line on.
    pub(super) fn actions(&self, actions: &mut [f32]) -> Result<(), Why<'t>> {
        let mut ahead = self.clone();
        while !ahead.line.starts_with(STEP) {
            if ahead.later.is_empty() {
                return Err(Why::Form);
            }
            ahead.next_line();
        }
        ahead.rest = ahead.line;
        ahead.skip(STEP)?;
        ahead.number::<u32>()?;
        ahead.skip(",\"actions\":")?;
        let count = ahead.list(|reader, index| {
            let place = actions.get_mut(2 * index..2 * index + 2);
            place.ok_or(Why::Form)?.copy_from_slice(&reader.pair()?);
            Ok(())
        })?;
        expect(2 * count == actions.len())
    }
}

/// How the line of a step begins.
pub(super) const STEP: &str = "{\"kind\":\"step\",\"t\":";

pub(super) fn expect<'t>(legal: bool) -> Result<(), Why<'t>> {
    if legal { Ok(()) } else { Err(Why::Form) }
}
