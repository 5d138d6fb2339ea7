//! Why a baseline cannot be had.

use core::fmt;

use super::kind::BaselineKind;

/// Why a baseline cannot be had.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PolicyError<'a> {
    /// No baseline has this name.
    UnknownPolicy(&'a str),
    /// No pilot mode has this name.
    UnknownPilot(&'a str),
    /// The mission does not allow this pilot density.
    PilotOutOfRange {
        /// What was asked for.
        density: f64,
        /// The least that is allowed.
        low: f64,
        /// The most that is allowed.
        high: f64,
    },
    /// It needs positions that are hidden.
    Hidden(BaselineKind),
}

impl fmt::Display for PolicyError<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownPolicy(name) => write!(
                out,
                "policy = {name}: must be one of random, greedy, swarm, teams, sweep, line, frontier, relay, \
                 charging, clean"
            ),
            Self::UnknownPilot(name) => write!(
                out,
                "pilot = {name}: must be one of min, mid, max, adaptive, or a density such as 0.15"
            ),
            Self::PilotOutOfRange { density, low, high } => write!(
                out,
                "pilot = {density}: must be a density from {low} (pilot_density_min) to {high} (pilot_density_max)"
            ),
            Self::Hidden(kind) => write!(
                out,
                "policy = {kind}: steers by positions that target_visibility = hidden withholds; \
                 must be one of random, sweep, line, frontier, relay"
            ),
        }
    }
}

impl std::error::Error for PolicyError<'_> {}
