//! A configuration put together from a preset, a file and single fields.
//!
//! The values stay a TOML table until all are known, so that each source replaces only what it names and
//! the checks see the sum. TOML rather than JSON in between: it can hold NaN and infinities, which then
//! are refused by the field that they were given for.

use std::path::Path;

use clap::ValueEnum;
use jcas_core::config::{FieldInfo, FieldValue};
use jcas_core::{Config, Preset};
use serde::Deserialize;
use toml::{Table, Value};

use crate::error::CliError;

/// The presets by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PresetName {
    /// The paper with its billing and payment corrected
    Mission,
    /// The letter of every equation of the paper
    Paper,
    /// Hidden hotspots that radar reaches from afar; UAVs share what they have looked at
    Search,
}

impl From<PresetName> for Preset {
    fn from(name: PresetName) -> Self {
        match name {
            PresetName::Mission => Self::Mission,
            PresetName::Paper => Self::Paper,
            PresetName::Search => Self::Search,
        }
    }
}

/// Values of fields, not yet checked against each other.
#[derive(Clone, Debug)]
pub struct ConfigSource {
    fields: Table,
}

impl ConfigSource {
    /// All values of a preset.
    pub fn preset(name: PresetName) -> Self {
        Self::of(&Config::preset(name.into()))
    }

    /// All values of a configuration.
    pub fn of(config: &Config) -> Self {
        let fields = Table::try_from(config)
            .expect("a configuration is a flat table of numbers, names and cells");
        Self { fields }
    }

    /// The fields that differ from another's, in the order of their declaration, each with words that say how.
    pub fn changes_from(&self, other: &Self) -> Vec<(&'static str, String)> {
        let shown = |value: Option<&Value>| value.map_or("derived".into(), Value::to_string);
        let fields = Config::FIELDS.iter().map(|info| info.name);
        fields
            .map(|name| (name, self.fields.get(name), other.fields.get(name)))
            .filter(|(_, now, before)| now != before)
            .map(|(name, now, before)| {
                let words = format!("{name} = {} (not {})", shown(now), shown(before));
                (name, words)
            })
            .collect()
    }

    /// Replaces the fields that a file names.
    pub fn overlay_file(&mut self, path: &Path) -> Result<(), CliError> {
        self.fields.extend(read_fields(path)?);
        Ok(())
    }

    /// Replaces one field.
    pub fn set(&mut self, field: &str, value: impl Into<Value>) {
        self.fields.insert(field.to_owned(), value.into());
    }

    /// Replaces the field of `field=value`.
    pub fn assign(&mut self, assignment: &str) -> Result<(), CliError> {
        let (field, text) = assignment.split_once('=').ok_or_else(|| {
            CliError::input(format!(
                "--set {assignment}: must be of the form field=value"
            ))
        })?;
        let (field, text) = (field.trim(), text.trim());
        check_name(field)?;
        if text == "none" {
            // Derived from other fields.
            self.fields.remove(field);
        } else {
            self.fields.insert(field.to_owned(), parse_value(text));
        }
        Ok(())
    }

    /// The configuration, with every field checked.
    pub fn resolve(&self) -> Result<Config, CliError> {
        let config =
            Config::deserialize(self.fields.clone()).map_err(|error| self.explain(&error))?;
        config.validate().map_err(CliError::input)?;
        Ok(config)
    }

    /// Names the field whose value is of the wrong type; serde's own message does not.
    fn explain(&self, error: &toml::de::Error) -> CliError {
        let culprit = self.fields.iter().find_map(|(field, value)| {
            let alone = Table::from_iter([(field.clone(), value.clone())]);
            let refused = Config::deserialize(alone).is_err();
            let info = Config::FIELDS.iter().find(|info| info.name == field)?;
            refused.then_some((info, value))
        });
        match culprit {
            Some((info, value)) => CliError::input(format!(
                "{} = {value}: must be {}",
                info.name,
                allowed(info)
            )),
            None => CliError::input(error.message()),
        }
    }
}

/// What a field accepts, in words.
fn allowed(info: &FieldInfo) -> String {
    let default = Config::default().values();
    let position = Config::FIELDS
        .iter()
        .position(|field| field.name == info.name);
    match position.map(|index| default[index]) {
        Some(FieldValue::Choice(..)) => format!("one of {}", info.unit.replace(" | ", ", ")),
        Some(FieldValue::Cells(_)) => format!("a list of at most {} cells [x, y]", info.high),
        Some(FieldValue::Integer(_)) => {
            format!("a whole number from {} to {}", info.low, info.high)
        }
        _ => format!("a number from {} to {}", info.low, info.high),
    }
}

/// The fields of a file. Names are checked here, values with those of the other sources.
fn read_fields(path: &Path) -> Result<Table, CliError> {
    let text = std::fs::read_to_string(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::InvalidData => CliError::file(path, "is not UTF-8 text"),
        _ => CliError::Io(path.to_owned(), error),
    })?;
    let json = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
    let fields: Table = if json {
        let mut fields: serde_json::Map<String, serde_json::Value> =
            serde_json::from_str(&text).map_err(|error| CliError::file(path, error))?;
        // TOML has no null; an absent field means the same.
        fields.retain(|_, value| !value.is_null());
        Table::try_from(fields).map_err(|error| CliError::file(path, error))?
    } else {
        toml::from_str(&text).map_err(|error| CliError::file(path, error))?
    };
    for field in fields.keys() {
        check_name(field).map_err(|error| CliError::file(path, error))?;
    }
    Ok(fields)
}

/// A value as TOML would read it; anything else is a name.
fn parse_value(text: &str) -> Value {
    toml::from_str::<Table>(&format!("value = {text}"))
        .ok()
        .and_then(|mut table| table.remove("value"))
        .unwrap_or_else(|| Value::String(text.to_owned()))
}

fn check_name(field: &str) -> Result<(), CliError> {
    if Config::FIELDS.iter().any(|info| info.name == field) {
        return Ok(());
    }
    let nearest = Config::FIELDS
        .iter()
        .map(|info| (edit_distance(field, info.name), info.name))
        .min();
    let hint = match nearest {
        Some((edits, name)) if edits <= 6 => format!("; did you mean {name}?"),
        _ => String::new(),
    };
    Err(CliError::input(format!(
        "{field}: no such field{hint} (`jcas config show` lists all)"
    )))
}

/// Levenshtein distance, for suggestions.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
