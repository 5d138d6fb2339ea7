//! The metadata of a policy's file about how the policy acts: its entry `jcas`.
//!
//! The entry holds pairs `key=value` with one space between them. An example is `mode=sampled
//! target_visibility=hidden pilot_density=0.15 fleet_size=read choices=read`.
//! Files of other trainers, and older ones (`{}`), state nothing.

use jcas_core::TargetVisibility;

use super::error::LoadError;
use crate::head::Mode;

/// The metadata of a policy: how it acts, and what it reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolicyMetadata {
    /// The acting mode.
    pub mode: Mode,
    /// The visibility that the policy was trained with; `None` if the file does not state it.
    pub target_visibility: Option<TargetVisibility>,
    /// The pilot density that overrides that of the network, in (0, 1]. `None` keeps that of the
    /// network.
    pub pilot_density: Option<f64>,
    /// Whether the last own field of a set network is the number of UAVs, which no observation
    /// holds.
    pub fleet_size: bool,
    /// Whether UAVs choose one after the other, by index. Each reads what its neighbours before it
    /// have chosen ([`read_choices`](super::choices::read_choices)), and how well each hotspot is
    /// covered ([`chance`](super::reach::chance)). It also reads which neighbours are in its cell
    /// or the next ([`describe_neighbour`](super::features::describe_neighbour)).
    pub choices: bool,
}

impl Default for PolicyMetadata {
    fn default() -> Self {
        Self {
            mode: Mode::Deterministic,
            target_visibility: None,
            pilot_density: None,
            fleet_size: false,
            choices: false,
        }
    }
}

impl PolicyMetadata {
    pub(crate) fn read(text: &str) -> Result<Self, LoadError> {
        let mut metadata = Self::default();
        if text.is_empty() || text == "{}" {
            return Ok(metadata);
        }
        for pair in text.split(' ') {
            match pair.split_once('=') {
                Some(("mode", name)) => {
                    metadata.mode = Mode::named(name).ok_or(LoadError::Metadata(
                        "mode: must be deterministic or sampled",
                    ))?;
                }
                Some(("target_visibility", "known")) => {
                    metadata.target_visibility = Some(TargetVisibility::Known);
                }
                Some(("target_visibility", "hidden")) => {
                    metadata.target_visibility = Some(TargetVisibility::Hidden);
                }
                Some(("target_visibility", _)) => {
                    return Err(LoadError::Metadata(
                        "target_visibility: must be known or hidden",
                    ));
                }
                Some(("pilot_density", density)) => {
                    let density = density
                        .parse()
                        .ok()
                        .filter(|density: &f64| *density > 0.0 && *density <= 1.0);
                    metadata.pilot_density = Some(density.ok_or(LoadError::Metadata(
                        "pilot_density: must be above 0 and at most 1",
                    ))?);
                }
                Some(("fleet_size", "read")) => metadata.fleet_size = true,
                Some(("fleet_size", _)) => {
                    return Err(LoadError::Metadata("fleet_size: must be read"));
                }
                Some(("choices", "read")) => metadata.choices = true,
                Some(("choices", _)) => {
                    return Err(LoadError::Metadata("choices: must be read"));
                }
                _ => {
                    return Err(LoadError::Metadata(
                        "must be of mode=, target_visibility=, pilot_density=, fleet_size= and \
                         choices=",
                    ));
                }
            }
        }
        Ok(metadata)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metadata_is_read_completely_or_refused() {
        assert_eq!(PolicyMetadata::read(""), Ok(PolicyMetadata::default()));
        assert_eq!(PolicyMetadata::read("{}"), Ok(PolicyMetadata::default()));
        let metadata = PolicyMetadata::read(
            "mode=sampled target_visibility=hidden pilot_density=0.15 fleet_size=read \
             choices=read",
        )
        .unwrap();
        assert_eq!(metadata.mode, Mode::Sampled);
        assert_eq!(metadata.target_visibility, Some(TargetVisibility::Hidden));
        assert_eq!(metadata.pilot_density, Some(0.15));
        assert!(metadata.fleet_size && metadata.choices);
        for wrong in [
            "mode=x",
            "target_visibility=",
            "pilot_density=NaN",
            "pilot_density=2",
            "fleet_size=20",
            "choices=1",
            "x",
            "mode=sampled ",
        ] {
            assert!(PolicyMetadata::read(wrong).is_err(), "{wrong}");
        }
    }
}
