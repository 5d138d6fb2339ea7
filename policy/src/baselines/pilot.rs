//! How a baseline sets its pilot density.

use core::fmt;

use jcas_core::{Config, Model, StateRef, TargetVisibility};

use super::error::PolicyError;

/// `adaptive` senses at full pilot density within this Manhattan distance of an unconfirmed hotspot.
///
/// With the default radar a UAV detects with probability 0.16 in the hotspot's own cell, 0.01 one cell
/// away and less than 0.001 beyond, so pilots farther off only cost throughput. One cell rather than
/// none: the density is chosen before the move and used after it.
pub const ADAPTIVE_RANGE_CELLS: u32 = 1;

/// The choice of pilot density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PilotMode {
    /// Always the least: the best links, the weakest sensing.
    Min,
    /// Always halfway.
    Mid,
    /// Always the most: the best sensing, the weakest links.
    Max,
    /// The most near an unconfirmed hotspot, the least elsewhere. Where positions are hidden: the most
    /// while any hotspot is unconfirmed.
    Adaptive,
    /// Always this density, kept within the mission's bounds.
    Held(f64),
}

impl PilotMode {
    /// All modes that have a name.
    pub const ALL: [Self; 4] = [Self::Min, Self::Mid, Self::Max, Self::Adaptive];

    /// As it is typed.
    #[must_use]
    pub fn name(self) -> String {
        self.to_string()
    }

    /// As it is typed, where it is no density.
    const fn word(self) -> Option<&'static str> {
        match self {
            Self::Min => Some("min"),
            Self::Mid => Some("mid"),
            Self::Max => Some("max"),
            Self::Adaptive => Some("adaptive"),
            Self::Held(_) => None,
        }
    }

    /// The mode of this name, or the density that the text says.
    ///
    /// # Errors
    /// [`PolicyError::UnknownPilot`].
    pub fn named(text: &str) -> Result<Self, PolicyError<'_>> {
        let held = || {
            text.parse()
                .ok()
                .filter(|density: &f64| density.is_finite())
        };
        Self::ALL
            .into_iter()
            .find(|mode| mode.word() == Some(text))
            .or_else(|| held().map(Self::Held))
            .ok_or(PolicyError::UnknownPilot(text))
    }

    /// Refuses a density that the mission does not allow.
    ///
    /// # Errors
    /// [`PolicyError::PilotOutOfRange`].
    pub fn check(self, config: &Config) -> Result<(), PolicyError<'static>> {
        let (low, high) = (config.pilot_density_min, config.pilot_density_max);
        match self {
            Self::Held(density) if !(low <= density && density <= high) => {
                Err(PolicyError::PilotOutOfRange { density, low, high })
            }
            _ => Ok(()),
        }
    }

    /// The action component u_pilot that is held throughout a mission; none where it adapts.
    #[must_use]
    pub fn held(self, config: &Config) -> Option<f32> {
        match self {
            Self::Min => Some(-1.0),
            Self::Mid => Some(0.0),
            Self::Max => Some(1.0),
            Self::Adaptive => None,
            Self::Held(density) => Some(action_of(config, density)),
        }
    }

    /// The action component u_pilot of one UAV.
    #[must_use]
    pub fn action(self, model: &Model<'_>, state: &StateRef<'_>, uav: usize) -> f32 {
        let adapted = || {
            if target_in_range(model, state, uav) {
                1.0
            } else {
                -1.0
            }
        };
        self.held(model.config()).unwrap_or_else(adapted)
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
            Self::Held(density) => density.clamp(low, high),
        }
    }
}

/// The action component u_pilot that gives a density: the kernel's map, inverted.
#[must_use]
pub fn action_of(config: &Config, density: f64) -> f32 {
    let (low, high) = (config.pilot_density_min, config.pilot_density_max);
    if high <= low {
        return 0.0;
    }
    (2.0 * (density - low) / (high - low) - 1.0).clamp(-1.0, 1.0) as f32
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
            (Self::Held(density), _) => density.fmt(out),
            (_, word) => out.write_str(word.unwrap_or_default()),
        }
    }
}
