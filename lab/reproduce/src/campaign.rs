//! Campaigns without training.

use jcas_core::{Config, Preset};
use jcas_policy::{BaselineKind, PilotMode};

/// Name in the table of a policy with our settings, trained here or given.
pub const OURS: &str = "learned";
/// Name in the table of a pilot density that is held at what the experiment varies.
pub const HELD: &str = "held";
/// Name in the table of a pilot density that its policy chooses.
pub const ADAPTIVE: &str = "adaptive";

/// A campaign without training.
#[derive(Clone, Debug)]
pub(crate) struct CampaignSpec {
    /// As in the table, with what it varies.
    pub experiment: (String, f64),
    /// Preset or configuration of which the mission is a variant.
    pub preset: Preset,
    /// The mission.
    pub config: Config,
    /// Policy of the campaign.
    pub who: Who,
}

/// A policy that is not trained for the campaign.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "few of them, each beside a mission of that size"
)]
pub(crate) enum Who {
    /// A script.
    Script(BaselineKind, PilotMode),
    /// The given policy that was trained on missions like `base`, if one exists.
    Ours {
        /// Configuration on which it has to be trained.
        base: Config,
        /// Its pilot density, if it is held.
        held: Option<f64>,
    },
}

/// Name in the table of a held pilot density, or of a learnt one.
pub(crate) fn pilot_name(constant: Option<f64>) -> &'static str {
    if constant.is_some() {
        "constant"
    } else {
        ADAPTIVE
    }
}
