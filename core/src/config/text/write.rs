//! Writes a configuration; fields that are derived from others are left out.

use core::fmt::{self, Write};

use crate::config::Config;

impl Config {
    /// Writes the configuration as a TOML text that [`Config::from_toml`] reads back.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_toml(&self, out: &mut impl Write) -> fmt::Result {
        for (info, value) in self.stated() {
            write!(out, "{} = ", info.name)?;
            write!(out, "{value}")?;
            out.write_char('\n')?;
        }
        Ok(())
    }

    /// Writes the configuration as a JSON object that [`Config::from_json`] reads back.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_json(&self, out: &mut impl Write) -> fmt::Result {
        let mut before = '{';
        for (info, value) in self.stated() {
            write!(out, "{before}\"{}\":", info.name)?;
            write!(out, "{value}")?;
            before = ',';
        }
        out.write_char('}')
    }

    /// Writes a JSON list that describes every field: name, unit, low, high, default and doc.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_fields(out: &mut impl Write) -> fmt::Result {
        let mut before = '[';
        for (info, default) in Self::FIELDS.iter().zip(Self::default().values()) {
            write!(out, "{before}{{\"name\":")?;
            write_text(out, info.name)?;
            out.write_str(",\"unit\":")?;
            write_text(out, info.unit)?;
            write!(
                out,
                ",\"low\":{:?},\"high\":{:?},\"default\":",
                info.low, info.high
            )?;
            if default.is_derived() {
                out.write_str("null")?;
            } else {
                write!(out, "{default}")?;
            }
            out.write_str(",\"doc\":")?;
            write_text(out, info.doc.trim())?;
            out.write_char('}')?;
            before = ',';
        }
        out.write_char(']')
    }
}

/// A text in quotes. Names and comments hold no control characters.
fn write_text(out: &mut impl Write, text: &str) -> fmt::Result {
    out.write_char('"')?;
    for character in text.chars() {
        if matches!(character, '"' | '\\') {
            out.write_char('\\')?;
        }
        out.write_char(character)?;
    }
    out.write_char('"')
}

/// Counts the bytes of what is written.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counter(pub usize);

impl Write for Counter {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0 += text.len();
        Ok(())
    }
}
