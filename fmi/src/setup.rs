//! The parameters of an instance, and the configuration that they make.

use std::path::PathBuf;

use jcas_core::config::FieldValue;
use jcas_core::{Config, MotionMap};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::episode::Inputs;
use crate::error::Error;

/// The parameters of an instance, which are fixed once the episode begins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    /// Name of the preset.
    pub preset: String,
    /// The fields of the configuration that were set, by name.
    pub fields: Map<String, Value>,
    /// Seed of the episode.
    pub seed: u64,
    /// Name of a baseline, or of a trained policy or a plan in the unit's resources. It is empty if
    /// the importer supplies the actions.
    pub policy: String,
    /// The pilot mode of a baseline.
    pub pilot: String,
    /// Whether the importer moves the UAVs.
    pub own_positions: bool,
    /// Whether the importer supplies the radio graph.
    pub own_links: bool,
    /// The folder of the unit's resources, which is no part of a saved state.
    #[serde(skip)]
    pub resources: Option<PathBuf>,
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            preset: "mission".to_owned(),
            fields: Map::new(),
            seed: 0,
            policy: String::new(),
            pilot: "adaptive".to_owned(),
            own_positions: false,
            own_links: false,
            resources: None,
        }
    }
}

impl Setup {
    /// Returns the validated configuration.
    ///
    /// # Errors
    /// The text names the field, the value and what is allowed.
    pub fn config(&self) -> Result<Config, Error> {
        let mut fields = self.fields.clone();
        fields.insert("preset".to_owned(), self.preset.clone().into());
        Ok(Config::from_json(&Value::from(fields).to_string())?)
    }

    /// Returns the file of the policy among the resources, by the ending of its name.
    #[must_use]
    pub fn resource(&self, ending: &str) -> Option<PathBuf> {
        // The policy is a name and not a path, so nothing outside the resources is read.
        let plain = self
            .policy
            .chars()
            .all(|letter| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-');
        let path = self
            .resources
            .as_ref()?
            .join(format!("{}.{ending}", self.policy));
        (plain && path.is_file()).then_some(path)
    }

    /// Returns the value of a field: the one that was set, else the preset's.
    ///
    /// # Errors
    /// The call fails if the preset does not exist.
    pub fn field(&self, name: &str) -> Result<Value, Error> {
        if let Some(value) = self.fields.get(name) {
            return Ok(value.clone());
        }
        let preset = self.preset.parse().map_err(|source| Error::Preset {
            name: self.preset.clone(),
            source,
        })?;
        let config = Config::preset(preset);
        let values = config.values();
        let index = Config::FIELDS.iter().position(|info| info.name == name);
        Ok(match index.map(|index| values[index]) {
            Some(FieldValue::Integer(value)) => value.into(),
            Some(FieldValue::Real(value) | FieldValue::Optional(Some(value))) => value.into(),
            Some(FieldValue::Choice(value, _)) => value.into(),
            Some(FieldValue::Cells(cells)) => cells
                .as_slice()
                .iter()
                .map(|cell| vec![cell.x, cell.y])
                .collect::<Vec<_>>()
                .into(),
            Some(FieldValue::Table(table)) => table
                .as_slice()
                .iter()
                .map(|point| vec![point.range_m, point.probability])
                .collect::<Vec<_>>()
                .into(),
            Some(FieldValue::Optional(None)) | None => Value::Null,
        })
    }

    /// Returns the inputs before the importer sets one: every UAV stays.
    ///
    /// # Errors
    /// The errors are those of [`Setup::field`].
    pub fn initial_inputs(&self) -> Result<Inputs, Error> {
        let map = self.field("motion_map")?;
        // A name that does not exist is refused with the configuration.
        let map = map.as_str().and_then(|name| name.parse::<MotionMap>().ok());
        let uavs = self.size("uav_count")? as usize;
        Ok(Inputs::of(uavs, map.unwrap_or_default()))
    }

    /// Returns a size: the one that was set, else the preset's.
    ///
    /// # Errors
    /// The errors are those of [`Setup::field`].
    pub fn size(&self, name: &str) -> Result<u64, Error> {
        self.field(name)?
            .as_u64()
            .ok_or_else(|| Error::NotWhole(name.to_owned()))
    }
}
