//! Builds a configuration from a preset, a file and single fields.
//!
//! Each source replaces only the fields that it names. Rules between fields are checked after the
//! last source.

use std::path::Path;

use clap::ValueEnum;
use jcas_core::config::FieldValue;
use jcas_core::config::text::Form;
use jcas_core::{Config, DetectionCurve, Preset};

use crate::error::CliError;
use crate::files;
use crate::radar_table::RadarTable;

/// The presets by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PresetName {
    /// The paper with its billing and payment corrected
    Mission,
    /// The letter of every equation of the paper
    Paper,
    /// Hidden hotspots that radar reaches from afar; UAVs share what they have looked at
    Search,
    /// A search with coherent pilots, a fluctuating echo, false alarms and reports
    Isac,
}

impl From<PresetName> for Preset {
    fn from(name: PresetName) -> Self {
        match name {
            PresetName::Mission => Self::Mission,
            PresetName::Paper => Self::Paper,
            PresetName::Search => Self::Search,
            PresetName::Isac => Self::Isac,
        }
    }
}

/// Values of fields that are not yet checked against each other.
#[derive(Clone, Debug)]
pub struct ConfigSource {
    config: Config,
}

impl ConfigSource {
    /// All values of a preset.
    pub fn preset(name: PresetName) -> Self {
        Self::of(&Config::preset(name.into()))
    }

    /// All values of a configuration.
    pub fn of(config: &Config) -> Self {
        Self { config: *config }
    }

    /// The fields that differ from those of `other`, in the order of their declaration, each with a
    /// description of the difference.
    pub fn changes_from(&self, other: &Self) -> Vec<(&'static str, String)> {
        let shown = |value: &FieldValue<'_>| match value.is_derived() {
            true => "derived".to_owned(),
            false => value.to_string(),
        };
        let (now, before) = (self.config.values(), other.config.values());
        Config::FIELDS
            .iter()
            .zip(now.iter().zip(&before))
            .filter(|(_, (now, before))| now != before)
            .map(|(info, (now, before))| {
                let words = format!("{} = {} (not {})", info.name, shown(now), shown(before));
                (info.name, words)
            })
            .collect()
    }

    /// Hash of the configuration, as tables and reports state it.
    pub fn hash(&self) -> String {
        format!("0x{:016x}", self.config.hash())
    }

    /// The preset with the fewest other values, and the fields that differ from it.
    pub fn nearest_preset(&self) -> String {
        let presets = Preset::ALL.iter().map(|preset| {
            let changes = self.changes_from(&Self::of(&Config::preset(*preset)));
            (preset.name(), changes)
        });
        let Some((name, changes)) = presets.min_by_key(|(_, changes)| changes.len()) else {
            return String::new();
        };
        let words: Vec<String> = changes.into_iter().map(|(_, words)| words).collect();
        match words.len() {
            0 => format!("preset {name}"),
            1..=6 => format!("preset {name} with {}", words.join(", ")),
            count => format!("preset {name} with {count} other values"),
        }
    }

    /// Replaces the fields that a file names. If the file names a preset, its values replace all
    /// fields first.
    pub fn overlay_file(&mut self, path: &Path) -> Result<(), CliError> {
        let text = files::read_text(path)?;
        let json = path
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
        let form = if json { Form::Json } else { Form::Toml };
        self.config = self
            .config
            .overlaid(&text, form)
            .map_err(|error| CliError::file(path, error))?;
        Ok(())
    }

    /// Replaces one field.
    pub fn set(&mut self, field: &str, value: u32) -> Result<(), CliError> {
        let assigned = self.config.assigned(field, &value.to_string());
        self.config = assigned.map_err(CliError::input)?;
        Ok(())
    }

    /// Replaces the field of `field=value`.
    pub fn assign(&mut self, assignment: &str) -> Result<(), CliError> {
        let (field, text) = assignment.split_once('=').ok_or_else(|| {
            CliError::input(format!(
                "--set {assignment}: must be of the form field=value"
            ))
        })?;
        let assigned = self.config.assigned(field.trim(), text.trim());
        self.config = assigned.map_err(CliError::input)?;
        Ok(())
    }

    /// Replaces the detection curve by the table of a file.
    pub(crate) fn set_radar_table(&mut self, table: &RadarTable) -> Result<(), CliError> {
        self.config.detection_table = table.at_density_max(self.config.pilot_density_max)?;
        self.config.detection_curve = DetectionCurve::Table;
        Ok(())
    }

    /// Returns the configuration after checking every field.
    pub fn resolve(&self) -> Result<Config, CliError> {
        self.config.validate().map_err(CliError::input)?;
        Ok(self.config)
    }
}
