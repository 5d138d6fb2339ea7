//! The errors of configuration texts.

use core::fmt;

use crate::config::{Config, FieldValue, UnknownName};
use crate::error::ConfigError;
use crate::words::printable::Printable;

/// Error in a configuration text.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum TextError {
    /// The text is not TOML or JSON.
    Syntax {
        /// Line of the error, from 1.
        line: u32,
        /// Column of the error in bytes, from 1.
        column: u32,
        /// Description of the text that was expected.
        expected: &'static str,
    },
    /// The key is not a field; the second part is a field with a similar name.
    Unknown(Excerpt, Option<&'static str>),
    /// The key occurs twice.
    Twice(Excerpt),
    /// No preset has this name.
    Preset(Excerpt, UnknownName),
    /// The value of the field has another type.
    Value(&'static str, Excerpt, Expected),
    /// The value of the field is outside its range.
    Config(ConfigError),
}

impl From<ConfigError> for TextError {
    fn from(error: ConfigError) -> Self {
        Self::Config(error)
    }
}

impl fmt::Display for TextError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax {
                line,
                column,
                expected,
            } => write!(out, "line {line} column {column}: must be {expected}"),
            Self::Unknown(key, Some(near)) => {
                write!(out, "{key}: no such field; did you mean {near}?")
            }
            Self::Unknown(key, None) => {
                write!(out, "{key}: no such field (`jcas config show` lists all)")
            }
            Self::Twice(key) => write!(out, "{key}: given twice, must be given once"),
            Self::Preset(name, error) => write!(out, "preset = {name}: {error}"),
            Self::Value(field, raw, expected) => write!(out, "{field} = {raw}: must be {expected}"),
            Self::Config(error) => error.fmt(out),
        }
    }
}

impl core::error::Error for TextError {}

/// What a field takes, by its position in [`Config::FIELDS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expected(usize);

impl Expected {
    pub(super) const fn of(index: usize) -> Self {
        Self(index)
    }
}

impl fmt::Display for Expected {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let info = &Config::FIELDS[self.0];
        match Config::default().values()[self.0] {
            FieldValue::Integer(_) => {
                write!(out, "a whole number from {} to {}", info.low, info.high)
            }
            FieldValue::Real(_) | FieldValue::Optional(_) => {
                write!(out, "a number from {} to {}", info.low, info.high)
            }
            FieldValue::Cells(_) => write!(out, "a list of at most {} cells [x, y]", info.high),
            FieldValue::Table(_) => write!(out, "a list of at most {} pairs [m, P_d]", info.high),
            FieldValue::Choice(..) => {
                out.write_str("one of ")?;
                for (index, name) in info.unit.split(" | ").enumerate() {
                    out.write_str(if index > 0 { ", " } else { "" })?;
                    out.write_str(name)?;
                }
                Ok(())
            }
        }
    }
}

const EXCERPT_BYTES: usize = 48;

/// The beginning of a text that was refused, for messages that stay short.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Excerpt {
    bytes: [u8; EXCERPT_BYTES],
    len: u8,
    quoted: bool,
    cut: bool,
}

impl Excerpt {
    /// The beginning of a text, up to the end of its line.
    #[must_use]
    pub fn of(text: &str) -> Self {
        let line = text.lines().next().unwrap_or_default();
        let mut end = line.len().min(EXCERPT_BYTES);
        while !line.is_char_boundary(end) {
            end -= 1;
        }
        let mut bytes = [0; EXCERPT_BYTES];
        bytes[..end].copy_from_slice(&line.as_bytes()[..end]);
        Self {
            bytes,
            len: end as u8,
            quoted: false,
            cut: end < text.len(),
        }
    }

    /// The same, shown in quotes.
    #[must_use]
    pub fn quoted(text: &str) -> Self {
        Self {
            quoted: true,
            ..Self::of(text)
        }
    }
}

impl fmt::Display for Excerpt {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let quote = if self.quoted { "\"" } else { "" };
        let text = core::str::from_utf8(&self.bytes[..self.len.into()]).unwrap_or_default();
        let dots = if self.cut { "..." } else { "" };
        write!(out, "{quote}{}{dots}{quote}", Printable(text))
    }
}

impl fmt::Debug for Excerpt {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, out)
    }
}
