//! A reader of traces, line by line and without an allocation. It accepts only the form that the
//! writer produces.

use core::str::FromStr;

use jcas_core::{Cell, Config};

use crate::error::{Problem, VerifyError};
use crate::line::FORMAT_VERSION;

/// Returns the configuration of a trace.
///
/// # Errors
/// The call fails if the first line is not the header of a trace, or its configuration is not
/// legal.
pub fn configuration(trace: &str) -> Result<Config, VerifyError<'_>> {
    Ok(Reader::new(trace).header()?.config)
}

/// Reads sixteen hexadecimal digits in lower case.
#[must_use]
pub fn hexadecimal(digits: &str) -> Option<u64> {
    let legal = digits.len() == 16
        && digits
            .bytes()
            .all(|digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f'));
    legal
        .then(|| u64::from_str_radix(digits, 16).ok())
        .flatten()
}

/// The parts of the first line that a replay needs.
pub(crate) struct Header<'t> {
    pub(crate) core_version: &'t str,
    pub(crate) config: Config,
    pub(crate) seed: u64,
    pub(crate) policy: &'t str,
    pub(crate) pilot: &'t str,
    pub(crate) line: &'t str,
}

/// A position in a trace.
#[derive(Clone)]
pub(crate) struct Reader<'t> {
    /// The lines before the first line that is read.
    before: &'t str,
    /// The present line.
    pub(crate) line: &'t str,
    /// The part of the line that is not yet read.
    pub(crate) rest: &'t str,
    /// The lines after the present one.
    pub(crate) later: &'t str,
    /// The line number, from 1 for the first line that is read.
    number: usize,
}

impl<'t> Reader<'t> {
    /// Starts at the first line of a trace.
    pub(crate) fn new(trace: &'t str) -> Self {
        let mut reader = Self {
            before: "",
            line: "",
            rest: "",
            later: trace,
            number: 0,
        };
        reader.next_line();
        reader
    }

    /// Starts at the line that begins at a byte offset.
    pub(crate) fn at(trace: &'t str, offset: usize) -> Result<Self, VerifyError<'t>> {
        match trace.split_at_checked(offset) {
            Some((before, later)) if !later.is_empty() => {
                let reader = Self::new(later);
                Ok(Self { before, ..reader })
            }
            _ => Err(VerifyError {
                line: 0,
                problem: Problem::Form,
            }),
        }
    }

    pub(crate) fn next_line(&mut self) {
        let end = self.later.find('\n').map_or(self.later.len(), |at| at + 1);
        let (line, later) = self.later.split_at(end);
        self.line = line;
        self.rest = line;
        self.later = later;
        self.number += 1;
    }

    pub(crate) fn error(&self, problem: Problem<'t>) -> VerifyError<'t> {
        let before = self.before.bytes().filter(|&byte| byte == b'\n').count();
        VerifyError {
            line: before + self.number,
            problem,
        }
    }

    pub(crate) fn skip(&mut self, text: &str) -> Result<(), Problem<'t>> {
        self.rest = self.rest.strip_prefix(text).ok_or(Problem::Form)?;
        Ok(())
    }

    /// Reads up to a character, which is not consumed.
    fn until(&mut self, stop: impl Fn(char) -> bool) -> Result<&'t str, Problem<'t>> {
        let at = self.rest.find(stop).ok_or(Problem::Form)?;
        let (text, rest) = self.rest.split_at(at);
        self.rest = rest;
        Ok(text)
    }

    pub(crate) fn number<T: FromStr>(&mut self) -> Result<T, Problem<'t>> {
        let digits = |c: char| !matches!(c, '0'..='9' | '-' | '+' | '.' | 'e');
        self.until(digits)?.parse().map_err(|_| Problem::Form)
    }

    /// Reads a number after the name of its field.
    pub(crate) fn field<T: FromStr>(&mut self, name: &str) -> Result<T, Problem<'t>> {
        self.skip(name)?;
        self.number()
    }

    /// Reads the text between quotes, with its escapes.
    pub(crate) fn text(&mut self) -> Result<&'t str, Problem<'t>> {
        let mut escaped = false;
        let at = self.rest.find(|c| {
            let ends = c == '"' && !escaped;
            escaped = c == '\\' && !escaped;
            ends
        });
        let (text, rest) = self.rest.split_at(at.ok_or(Problem::Form)?);
        self.rest = rest;
        Ok(text)
    }

    fn hex(&mut self) -> Result<u64, Problem<'t>> {
        let (digits, rest) = self.rest.split_at_checked(16).ok_or(Problem::Form)?;
        self.rest = rest;
        hexadecimal(digits).ok_or(Problem::Form)
    }

    /// Reads a list, and calls `each` before every element with its index.
    pub(crate) fn list(
        &mut self,
        mut each: impl FnMut(&mut Self, usize) -> Result<(), Problem<'t>>,
    ) -> Result<usize, Problem<'t>> {
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

    /// Reads a list of exactly the length of `out`.
    pub(crate) fn fill<'a, T>(
        &mut self,
        out: &'a mut [T],
        mut read: impl FnMut(&mut Self) -> Result<T, Problem<'t>>,
    ) -> Result<&'a [T], Problem<'t>> {
        let count = self.list(|reader, index| {
            *out.get_mut(index).ok_or(Problem::Form)? = read(reader)?;
            Ok(())
        })?;
        expect(count == out.len())?;
        Ok(out)
    }

    pub(crate) fn pair<T: FromStr>(&mut self) -> Result<[T; 2], Problem<'t>> {
        self.skip("[")?;
        let first = self.number()?;
        self.skip(",")?;
        let second = self.number()?;
        self.skip("]")?;
        Ok([first, second])
    }

    pub(crate) fn cell(&mut self) -> Result<Cell, Problem<'t>> {
        let [x, y] = self.pair()?;
        Ok(Cell { x, y })
    }

    pub(crate) fn header(&mut self) -> Result<Header<'t>, VerifyError<'t>> {
        self.read_header().map_err(|problem| self.error(problem))
    }

    fn read_header(&mut self) -> Result<Header<'t>, Problem<'t>> {
        self.skip("{\"kind\":\"header\",\"format\":\"jcas-trace\",\"format_version\":")?;
        expect(self.number::<u32>()? == FORMAT_VERSION)?;
        self.skip(",\"core_version\":\"")?;
        let core_version = self.text()?;
        self.skip("\",\"config\":")?;
        let text = self.rest;
        let braced = self.until(|c| c == '}')?.len() + 1;
        let config = Config::from_json(&text[..braced]).map_err(Problem::Config)?;
        self.skip("},\"config_hash\":\"0x")?;
        self.hex()?;
        self.skip("\",\"seed\":\"0x")?;
        let seed = self.hex()?;
        self.skip("\",\"policy\":\"")?;
        let policy = self.text()?;
        self.skip("\",\"pilot\":\"")?;
        let pilot = self.text()?;
        Ok(Header {
            core_version,
            config,
            seed,
            policy,
            pilot,
            line: self.line,
        })
    }

    /// Returns the actions of the next step in the file, from this line on.
    pub(crate) fn actions(&self, actions: &mut [f32]) -> Result<(), Problem<'t>> {
        let mut ahead = self.clone();
        while !ahead.line.starts_with(STEP) {
            if ahead.later.is_empty() {
                return Err(Problem::Form);
            }
            ahead.next_line();
        }
        ahead.rest = ahead.line;
        ahead.skip(STEP)?;
        ahead.number::<u32>()?;
        ahead.skip(",\"actions\":")?;
        let count = ahead.list(|reader, index| {
            let place = actions.get_mut(2 * index..2 * index + 2);
            place.ok_or(Problem::Form)?.copy_from_slice(&reader.pair()?);
            Ok(())
        })?;
        expect(2 * count == actions.len())
    }
}

/// The beginning of the line of a step.
pub(crate) const STEP: &str = "{\"kind\":\"step\",\"t\":";

pub(crate) fn expect<'t>(legal: bool) -> Result<(), Problem<'t>> {
    if legal { Ok(()) } else { Err(Problem::Form) }
}
