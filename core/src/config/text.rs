//! Configurations as TOML or JSON text, judged alike by every door of the library.
//!
//! A text may name a `preset` (default `mission`); every other key is a field of [`Config`] and
//! replaces the preset's value. A key that is unknown or comes twice is an error. `null` (JSON) and
//! `"none"` take a real number that may be derived from others back to that. Reading and writing
//! allocate nothing.

mod error;
mod scan;
mod value;
mod write;

pub use error::{Excerpt, TextError};
pub use value::{Pairs, TextValue};
pub use write::Counter;

use super::{Config, Preset};
use error::Expected;
use scan::Scanner;

/// How a configuration is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// `key = value` lines.
    Toml,
    /// One object.
    Json,
}

impl Config {
    /// Reads and validates a TOML text.
    ///
    /// # Errors
    /// [`TextError`] naming the key, the value and what is allowed.
    pub fn from_toml(text: &str) -> Result<Self, TextError> {
        let config = Self::default().overlaid(text, Form::Toml)?;
        config.validate()?;
        Ok(config)
    }

    /// Reads and validates a JSON text.
    ///
    /// # Errors
    /// The errors of [`Config::from_toml`].
    pub fn from_json(text: &str) -> Result<Self, TextError> {
        let config = Self::default().overlaid(text, Form::Json)?;
        config.validate()?;
        Ok(config)
    }

    /// Replaces the fields that a text names; all of them, first, if it names a preset. The result
    /// has yet to be validated.
    ///
    /// # Errors
    /// [`TextError`], but for the ranges of fields and the rules between them.
    pub fn overlaid(self, text: &str, form: Form) -> Result<Self, TextError> {
        let mut scanner = Scanner::new(text, form);
        let mut preset = None;
        let mut begins: [Option<usize>; Self::FIELD_COUNT] = [None; Self::FIELD_COUNT];
        while let Some((key, begin)) = scanner.entry()? {
            let seen_before = if key == "preset" {
                preset.replace(begin).is_some()
            } else {
                let index = Self::field_index(key)?;
                begins[index].replace(begin).is_some()
            };
            if seen_before {
                return Err(TextError::Twice(Excerpt::of(key)));
            }
        }
        let mut config = match preset {
            None => self,
            Some(begin) => Self::preset(preset_of(scanner.value_at(begin)?)?),
        };
        for (index, begin) in begins.iter().enumerate() {
            if let Some(begin) = *begin {
                let (value, raw) = scanner.value_at(begin)?;
                config.replace(index, &value, Excerpt::of(raw))?;
            }
        }
        Ok(config)
    }

    /// Replaces one field by a value from a command line. `text` is a value as in TOML, a name
    /// without quotes, or `none` for a field that can be derived. The result is not validated.
    ///
    /// # Errors
    /// The errors of [`Config::overlaid`].
    pub fn assigned(mut self, field: &str, text: &str) -> Result<Self, TextError> {
        let index = Self::field_index(field)?;
        let mut scanner = Scanner::new(text, Form::Toml);
        match scanner.lone_value() {
            Ok(value) if value != TextValue::Other => {
                self.replace(index, &value, Excerpt::of(text))?;
            }
            _ if text == "none" => self.replace(index, &TextValue::Null, Excerpt::of(text))?,
            _ => self.replace(index, &TextValue::Name(text), Excerpt::quoted(text))?,
        }
        Ok(self)
    }

    fn field_index(key: &str) -> Result<usize, TextError> {
        Self::FIELDS
            .iter()
            .position(|info| info.name == key)
            .ok_or_else(|| TextError::Unknown(Excerpt::of(key), nearest(key)))
    }

    fn replace(
        &mut self,
        index: usize,
        value: &TextValue<'_>,
        raw: Excerpt,
    ) -> Result<(), TextError> {
        if self.set_value(index, value) {
            Ok(())
        } else {
            let expected = Expected::of(index);
            Err(TextError::Value(Self::FIELDS[index].name, raw, expected))
        }
    }
}

fn preset_of((value, raw): (TextValue<'_>, &str)) -> Result<Preset, TextError> {
    let name = match value {
        TextValue::Name(name) => name,
        _ => raw,
    };
    name.parse()
        .map_err(|error| TextError::Preset(Excerpt::of(name), error))
}

/// Names that other libraries use, each with the field that it means here.
const FOREIGN: [(&str, &str); 6] = [
    ("max_episode_steps", "horizon_steps"),
    ("max_steps", "horizon_steps"),
    ("max_cycles", "horizon_steps"),
    ("num_agents", "uav_count"),
    ("n_agents", "uav_count"),
    ("grid_size", "grid_width"),
];

/// The field that a wrong key most likely meant: the one of another library's name, else the one
/// that shares the longest beginning with it.
fn nearest(key: &str) -> Option<&'static str> {
    if let Some((_, field)) = FOREIGN.iter().find(|(name, _)| *name == key) {
        return Some(field);
    }
    let shared = |name: &str| {
        name.bytes()
            .zip(key.bytes())
            .take_while(|(a, b)| a == b)
            .count()
    };
    let near = Config::FIELDS.iter().max_by_key(|info| shared(info.name))?;
    (shared(near.name) >= 3).then_some(near.name)
}

#[cfg(test)]
mod tests;
