//! Configurations as TOML or JSON text.
//!
//! A text may name a `preset` (default `mission`); every other key is a field of [`Config`] and replaces
//! the preset's value. Unknown keys are errors.

use alloc::borrow::ToOwned;
use alloc::format;
use alloc::string::{String, ToString};
use core::fmt;

use serde_json::{Map, Value};

use super::{Config, Preset};
use crate::error::ConfigError;

/// Why a text is not a configuration.
#[derive(Clone, Debug, PartialEq)]
pub enum TextError {
    /// Not TOML or JSON, or a key or type that no field has. The message names it.
    Syntax(String),
    /// A field outside its range.
    Config(ConfigError),
}

impl fmt::Display for TextError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax(message) => out.write_str(message),
            Self::Config(error) => error.fmt(out),
        }
    }
}

impl core::error::Error for TextError {}

impl From<ConfigError> for TextError {
    fn from(error: ConfigError) -> Self {
        Self::Config(error)
    }
}

impl Config {
    /// Reads and validates a TOML text.
    ///
    /// # Errors
    /// [`TextError`] naming the key, the value and what is allowed.
    pub fn from_toml(text: &str) -> Result<Self, TextError> {
        let table: toml::Table = text.parse().map_err(|error: toml::de::Error| {
            TextError::Syntax(error.to_string().trim_end().to_owned())
        })?;
        let mut fields = Map::new();
        for (key, value) in table {
            if let toml::Value::Float(real) = value {
                // JSON has no NaN or infinity, so these would lose their name on the way.
                if !real.is_finite() {
                    return Err(not_finite(&key, real));
                }
            }
            let value = serde_json::to_value(value)
                .map_err(|error| TextError::Syntax(format!("{key}: {error}")))?;
            fields.insert(key, value);
        }
        Self::from_fields(fields)
    }

    /// Reads and validates a JSON text.
    ///
    /// # Errors
    /// As [`Config::from_toml`].
    pub fn from_json(text: &str) -> Result<Self, TextError> {
        let fields: Map<String, Value> =
            serde_json::from_str(text).map_err(|error| TextError::Syntax(error.to_string()))?;
        Self::from_fields(fields)
    }

    /// Lays fields over the preset that they name and validates the result.
    ///
    /// # Errors
    /// As [`Config::from_toml`].
    pub fn from_fields(mut fields: Map<String, Value>) -> Result<Self, TextError> {
        let preset = match fields.remove("preset") {
            None => Preset::Mission,
            Some(Value::String(name)) => name
                .parse()
                .map_err(|error| TextError::Syntax(format!("preset = {name}: {error}")))?,
            Some(other) => {
                let message = format!("preset = {other}: must be a name in quotes");
                return Err(TextError::Syntax(message));
            }
        };
        Self::preset(preset).with_fields(fields)
    }

    /// Replaces the given fields and validates the result.
    ///
    /// # Errors
    /// As [`Config::from_toml`].
    pub fn with_fields(self, fields: Map<String, Value>) -> Result<Self, TextError> {
        let mut all = match serde_json::to_value(self) {
            Ok(Value::Object(all)) => all,
            _ => {
                return Err(TextError::Syntax(
                    "the configuration is not a record".to_owned(),
                ));
            }
        };
        for (key, value) in fields {
            let Some(info) = Self::FIELDS.iter().find(|info| info.name == key) else {
                return Err(TextError::Syntax(unknown_field(&key)));
            };
            // Each field is tried alone first, so that a wrong type is reported with its name.
            let mut alone = Map::new();
            alone.insert(key.clone(), value.clone());
            if let Err(error) = serde_json::from_value::<Self>(Value::Object(alone)) {
                return Err(TextError::Syntax(format!(
                    "{key} = {value}: {error} (unit {}, from {} to {})",
                    info.unit, info.low, info.high
                )));
            }
            all.insert(key, value);
        }
        let config: Self = serde_json::from_value(Value::Object(all))
            .map_err(|error| TextError::Syntax(error.to_string()))?;
        config.validate()?;
        Ok(config)
    }

    /// The configuration as a TOML text that [`Config::from_toml`] reads back.
    #[must_use]
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }
}

fn not_finite(key: &str, value: f64) -> TextError {
    match Config::FIELDS.iter().find(|info| info.name == key) {
        Some(info) => TextError::Syntax(format!(
            "{key} = {value}: must be a number from {} to {}",
            info.low, info.high
        )),
        None => TextError::Syntax(unknown_field(key)),
    }
}

/// Names the unknown field and the known one that shares the longest beginning with it.
fn unknown_field(key: &str) -> String {
    let shared = |name: &str| {
        name.bytes()
            .zip(key.bytes())
            .take_while(|(a, b)| a == b)
            .count()
    };
    let near = Config::FIELDS.iter().max_by_key(|info| shared(info.name));
    match near {
        Some(info) if shared(info.name) >= 3 => {
            format!("{key}: no such field; did you mean {}?", info.name)
        }
        _ => format!("{key}: no such field; `jcas config show` lists them all"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn toml_and_json_agree_and_round_trip() {
        let toml = Config::from_toml("preset = 'paper'\nuav_count = 15\ndepots = [[0, 0], [3, 4]]")
            .unwrap();
        let json = Config::from_json(
            r#"{"preset": "paper", "uav_count": 15, "depots": [[0, 0], [3, 4]]}"#,
        )
        .unwrap();
        assert_eq!(toml, json);
        assert_eq!(toml.hash(), json.hash());
        assert_eq!(Config::from_toml(&toml.to_toml()).unwrap(), toml);
        assert_ne!(toml.hash(), Config::default().hash());
    }

    #[test]
    fn messages_name_field_value_and_what_is_allowed() {
        let refused = |text: &str| Config::from_toml(text).unwrap_err().to_string();
        assert_eq!(
            refused("uav_count = 0"),
            "uav_count = 0: must be a number from 1 to 4096"
        );
        assert_eq!(
            refused("uav_cuont = 5"),
            "uav_cuont: no such field; did you mean uav_count?"
        );
        assert_eq!(
            refused("cell_size_m = nan"),
            "cell_size_m = NaN: must be a number from 0.001 to 1000000"
        );
        assert_eq!(
            refused("pilot_density_min = 0.4"),
            "pilot_density_min = 0.4: must be at most 0.3 (pilot_density_max)"
        );
        assert!(refused("uav_count = -3").starts_with("uav_count = -3: "));
        assert!(refused("move_energy_kwh = -1e-3").contains("must be a number from 0 to 1"));
        assert!(refused("hotspot_count = 150").contains("must be at most 143"));
        assert!(refused("depots = [[12, 0]]").contains("[12, 0]"));
        assert!(refused("preset = 'best'").contains("`mission`, `paper` or `search`"));
        assert_eq!(
            refused("map_window_radius = 3"),
            "map_window_radius = 3: must be 0 (off) while search_maps is off"
        );
        assert!(
            refused("map_directions = 'shown'").starts_with("map_directions = 1: must be 0 (off)")
        );
        assert_eq!(
            refused(
                "search_maps = 'shared'\nuav_count = 4096\ngrid_width = 1024\ngrid_height = 1024"
            ),
            "uav_count = 4096: must be at most 256 (with search_maps = shared, 2^28 over the cells \
             of the grid)"
        );
        assert!(
            refused("horizon_steps = 1000000\nuav_count = 4096\ncharge_power_kw = 10000")
                .contains("2^62")
        );
    }
}
