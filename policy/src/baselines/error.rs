//! The errors of building a baseline.

use core::fmt;

use jcas_core::Printable;

use super::kind::BaselineKind;

/// A reason for which a baseline cannot be built.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PolicyError<'a> {
    /// No baseline has this name.
    UnknownPolicy(&'a str),
    /// No pilot mode has this name.
    UnknownPilot(&'a str),
    /// The model does not allow this pilot density.
    PilotOutOfRange {
        /// The requested density.
        density: f64,
        /// The minimum of the model.
        low: f64,
        /// The maximum of the model.
        high: f64,
    },
    /// The baseline reads positions that the model hides.
    Hidden(BaselineKind),
}

impl fmt::Display for PolicyError<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownPolicy(name) => write!(
                out,
                "policy = {}: must be one of random, untrained, greedy, swarm, teams, squads, \
                 sweep, line, frontier, relay, answer, charging, clean",
                Printable(name)
            ),
            Self::UnknownPilot(name) => write!(
                out,
                "pilot = {}: must be one of min, mid, max, adaptive, myopic, or a density such as \
                 0.15",
                Printable(name)
            ),
            Self::PilotOutOfRange { density, low, high } => write!(
                out,
                "pilot = {density}: must be a density from {low} (pilot_density_min) to {high} \
                 (pilot_density_max)"
            ),
            Self::Hidden(kind) => write!(
                out,
                "policy = {kind}: steers by positions that target_visibility = hidden withholds; \
                 must be one of random, untrained, sweep, line, frontier, relay, answer"
            ),
        }
    }
}

impl std::error::Error for PolicyError<'_> {}
