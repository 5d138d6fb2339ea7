//! The cells of a sweep: every combination of the listed values.

use jcas_core::{Config, Model};

use crate::config_source::ConfigSource;
use crate::error::CliError;
use crate::options::policy_factory;

/// A setting with the list of its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// Column in the table: `policy`, `pilot`, or a field of the configuration.
    pub name: String,
    /// The values as they were typed.
    pub values: Vec<String>,
}

impl Axis {
    /// Builds an axis over values that have a text.
    pub fn new(name: &str, values: impl IntoIterator<Item = impl ToString>) -> Self {
        Self {
            name: name.to_owned(),
            values: values.into_iter().map(|value| value.to_string()).collect(),
        }
    }

    /// Reads `field=value,value`.
    pub fn parse(text: &str) -> Result<Self, CliError> {
        match text.split_once('=') {
            Some((field, values)) if !values.is_empty() => {
                Ok(Self::new(field.trim(), values.split(',').map(str::trim)))
            }
            _ => Err(CliError::input(format!(
                "--vary {text}: must be of the form field=value,value"
            ))),
        }
    }
}

/// One combination of values.
#[derive(Clone, Debug)]
pub struct SweepCell {
    /// The value on each axis, as it was typed.
    pub values: Vec<String>,
    /// The policy.
    pub policy: String,
    /// Its pilot mode.
    pub pilot: String,
    /// The configuration.
    pub config: Config,
}

/// Every cell of the grid, with the last axis varying fastest. All cells are checked before the
/// first one runs.
pub fn cells(base: &ConfigSource, axes: &[Axis]) -> Result<Vec<SweepCell>, CliError> {
    for (index, axis) in axes.iter().enumerate() {
        if axes[..index].iter().any(|other| other.name == axis.name) {
            return Err(CliError::input(format!(
                "{} is listed twice: must be one list",
                axis.name
            )));
        }
    }
    combinations(axes)
        .into_iter()
        .map(|values| cell(base, axes, values))
        .collect()
}

fn cell(base: &ConfigSource, axes: &[Axis], values: Vec<String>) -> Result<SweepCell, CliError> {
    let mut source = base.clone();
    let (mut policy, mut pilot) = (String::new(), String::new());
    for (axis, value) in axes.iter().zip(&values) {
        match axis.name.as_str() {
            "policy" => policy.clone_from(value),
            "pilot" => pilot.clone_from(value),
            field => source.assign(&format!("{field}={value}"))?,
        }
    }
    let config = source.resolve()?;
    // An invalid cell is refused before the first one runs.
    let _ = policy_factory(&policy, &pilot, &Model::new(config)?)?;
    Ok(SweepCell {
        values,
        policy,
        pilot,
        config,
    })
}

fn combinations(axes: &[Axis]) -> Vec<Vec<String>> {
    axes.iter().fold(vec![Vec::new()], |combinations, axis| {
        combinations
            .iter()
            .flat_map(|combination| {
                axis.values.iter().map(move |value| {
                    let mut longer = combination.clone();
                    longer.push(value.clone());
                    longer
                })
            })
            .collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_axis_runs_fastest() {
        let axes = [Axis::new("a", [1, 2]), Axis::new("b", ["x", "y", "z"])];
        let all = combinations(&axes);
        assert_eq!(all.len(), 6);
        assert_eq!(all[0], ["1", "x"]);
        assert_eq!(all[1], ["1", "y"]);
        assert_eq!(all[5], ["2", "z"]);
    }

    #[test]
    fn a_list_needs_a_field_and_a_value() {
        let axis = Axis::parse("horizon_steps=50, 100").unwrap();
        assert_eq!(axis, Axis::new("horizon_steps", [50, 100]));
        assert!(Axis::parse("horizon_steps").is_err());
        assert!(Axis::parse("horizon_steps=").is_err());
    }
}
