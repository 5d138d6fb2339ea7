//! The choice of pilot density of a baseline.

use core::fmt;

use jcas_core::{Config, Model, StateRef, TargetVisibility};

use super::error::PolicyError;
use crate::action_of;

/// The Manhattan distance in cells of an unconfirmed hotspot within which `adaptive` senses at full
/// pilot density.
///
/// With the default radar a UAV detects with probability 0.16 in the hotspot's own cell and 0.01
/// one cell away. Beyond, it is less than 0.001, so pilots only cost throughput there. The range is
/// one cell, not zero, as the density is chosen before the move and used after it.
pub const ADAPTIVE_RANGE_CELLS: u32 = 1;

/// A rule for the pilot density of a UAV.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PilotMode {
    /// The rule always takes the minimum: the best links, the weakest sensing.
    Min,
    /// The rule always takes the mean of minimum and maximum.
    Mid,
    /// The rule always takes the maximum: the best sensing, the weakest links.
    Max,
    /// The rule takes the maximum near an unconfirmed hotspot and the minimum elsewhere. With
    /// hidden positions, it takes the maximum while any hotspot is unconfirmed.
    Adaptive,
    /// The rule always takes this density, clipped to the bounds of the model.
    Fixed(f64),
}

impl PilotMode {
    /// All modes that have a name.
    pub const ALL: [Self; 4] = [Self::Min, Self::Mid, Self::Max, Self::Adaptive];

    /// The name of the mode, or the density in decimal digits.
    #[must_use]
    pub fn name(self) -> String {
        self.to_string()
    }

    /// The name of the mode; `None` for a fixed density.
    const fn word(self) -> Option<&'static str> {
        match self {
            Self::Min => Some("min"),
            Self::Mid => Some("mid"),
            Self::Max => Some("max"),
            Self::Adaptive => Some("adaptive"),
            Self::Fixed(_) => None,
        }
    }

    /// Parses the name of a mode, or a density.
    ///
    /// # Errors
    /// [`PolicyError::UnknownPilot`] if the text is neither.
    pub fn named(text: &str) -> Result<Self, PolicyError<'_>> {
        let density = || {
            text.parse()
                .ok()
                .filter(|density: &f64| density.is_finite())
        };
        Self::ALL
            .into_iter()
            .find(|mode| mode.word() == Some(text))
            .or_else(|| density().map(Self::Fixed))
            .ok_or(PolicyError::UnknownPilot(text))
    }

    /// Checks that the model allows the density.
    ///
    /// # Errors
    /// [`PolicyError::PilotOutOfRange`] if it does not.
    pub fn check(self, config: &Config) -> Result<(), PolicyError<'static>> {
        let (low, high) = (config.pilot_density_min, config.pilot_density_max);
        match self {
            Self::Fixed(density) if !(low <= density && density <= high) => {
                Err(PolicyError::PilotOutOfRange { density, low, high })
            }
            _ => Ok(()),
        }
    }

    /// The action component u_pilot that is constant throughout an episode. `None` for a mode that
    /// follows the state.
    #[must_use]
    pub fn fixed(self, config: &Config) -> Option<f32> {
        match self {
            Self::Min => Some(-1.0),
            Self::Mid => Some(0.0),
            Self::Max => Some(1.0),
            Self::Adaptive => None,
            Self::Fixed(density) => Some(action_of(config, density)),
        }
    }

    /// The action component u_pilot of one UAV, in [-1, 1].
    #[must_use]
    pub fn action(self, model: &Model<'_>, state: &StateRef<'_>, uav: usize) -> f32 {
        let adapted = || {
            if target_in_range(model, state, uav) {
                1.0
            } else {
                -1.0
            }
        };
        self.fixed(model.config()).unwrap_or_else(adapted)
    }

    /// The pilot density at which this mode senses a hotspot that it has reached.
    #[must_use]
    pub fn sensing_density(self, model: &Model<'_>) -> f64 {
        let (low, high) = (
            model.config().pilot_density_min,
            model.config().pilot_density_max,
        );
        match self {
            Self::Min => low,
            Self::Mid => low + 0.5 * (high - low),
            Self::Max | Self::Adaptive => high,
            Self::Fixed(density) => density.clamp(low, high),
        }
    }
}

fn target_in_range(model: &Model<'_>, state: &StateRef<'_>, uav: usize) -> bool {
    let hidden = model.config().target_visibility == TargetVisibility::Hidden;
    (0..model.hotspot_count()).any(|hotspot| {
        !state.confirmed(hotspot)
            && (hidden
                || state.cell(uav).manhattan(state.hotspot_cell(hotspot)) <= ADAPTIVE_RANGE_CELLS)
    })
}

impl fmt::Display for PilotMode {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self, self.word()) {
            (Self::Fixed(density), _) => density.fmt(out),
            (_, word) => out.write_str(word.unwrap_or_default()),
        }
    }
}
