//! How a baseline sets its pilot density.

use core::fmt;
use core::str::FromStr;

use jcas_core::{Model, StateRef, TargetVisibility};

use super::baseline::PolicyError;

/// `adaptive` senses at full pilot density within this Manhattan distance of an unconfirmed hotspot.
///
/// With the default radar a UAV detects with probability 0.16 in the hotspot's own cell, 0.01 one cell
/// away and less than 0.001 beyond, so pilots farther off only cost throughput. One cell rather than
/// none: the density is chosen before the move and used after it.
pub const ADAPTIVE_RANGE_CELLS: u32 = 1;

/// The choice of pilot density.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
}

impl PilotMode {
    /// All modes.
    pub const ALL: [Self; 4] = [Self::Min, Self::Mid, Self::Max, Self::Adaptive];

    /// As it is typed.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Min => "min",
            Self::Mid => "mid",
            Self::Max => "max",
            Self::Adaptive => "adaptive",
        }
    }

    /// The action component u_pilot of one UAV.
    #[must_use]
    pub fn action(self, model: &Model<'_>, state: &StateRef<'_>, uav: usize) -> f32 {
        match self {
            Self::Min => -1.0,
            Self::Mid => 0.0,
            Self::Max => 1.0,
            Self::Adaptive if target_in_range(model, state, uav) => 1.0,
            Self::Adaptive => -1.0,
        }
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
        out.write_str(self.name())
    }
}

impl FromStr for PilotMode {
    type Err = PolicyError;

    fn from_str(text: &str) -> Result<Self, PolicyError> {
        Self::ALL
            .into_iter()
            .find(|mode| mode.name() == text)
            .ok_or_else(|| PolicyError::UnknownPilot(text.to_owned()))
    }
}
