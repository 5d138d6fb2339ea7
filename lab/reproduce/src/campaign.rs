//! Campaigns that take no training.

use jcas_core::{Config, Preset};
use jcas_policy::{BaselineKind, PilotMode};

/// Name in the table of a policy with our settings, trained here or given.
pub const OURS: &str = "learned";
/// Name in the table of a pilot density that is held at what the experiment varies.
pub const HELD: &str = "held";
/// Name in the table of a pilot density that its policy chooses.
pub const ADAPTIVE: &str = "adaptive";

/// A campaign that takes no training.
#[derive(Clone, Debug)]
pub(crate) struct CampaignSpec {
    /// As in the table, with what it varies.
    pub experiment: (String, f64),
    /// What the mission is a variant of.
    pub preset: Preset,
    /// The mission.
    pub config: Config,
    /// Who flies.
    pub who: Who,
}

/// Who flies without being trained for it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "few of them, each beside a mission of that size"
)]
pub(crate) enum Who {
    /// A script.
    Script(BaselineKind, PilotMode),
    /// Ours, where one is given that was trained on missions like `base`.
    Ours {
        /// What it has to be trained on.
        base: Config,
        /// Its pilot density, if it is held.
        held: Option<f64>,
    },
}

/// The pilot rule of who holds a density, or learns to choose it.
pub(crate) fn pilot_name(constant: Option<f64>) -> &'static str {
    if constant.is_some() {
        "constant"
    } else {
        ADAPTIVE
    }
}
