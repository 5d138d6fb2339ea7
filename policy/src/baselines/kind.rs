//! The names of the baselines.

use core::fmt;

/// A baseline by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaselineKind {
    /// [`Random`](super::Random).
    Random,
    /// [`Greedy`](super::Greedy).
    Greedy,
    /// [`Swarm`](super::Swarm).
    Swarm,
    /// [`Teams`](super::Teams).
    Teams,
    /// [`Sweep`](super::Sweep).
    Sweep,
    /// [`Line`](super::Line).
    Line,
    /// [`Frontier`](super::Frontier).
    Frontier,
    /// [`Frontier::connected`](super::Frontier::connected).
    Relay,
    /// [`Answer`](super::Answer).
    Answer,
    /// [`Charging::greedy`](super::Charging::greedy).
    Charging,
    /// [`Charging::clean`](super::Charging::clean).
    Clean,
}

impl BaselineKind {
    /// All baselines.
    pub const ALL: [Self; 11] = [
        Self::Random,
        Self::Greedy,
        Self::Swarm,
        Self::Teams,
        Self::Sweep,
        Self::Line,
        Self::Frontier,
        Self::Relay,
        Self::Answer,
        Self::Charging,
        Self::Clean,
    ];

    /// The name of the baseline.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Greedy => "greedy",
            Self::Swarm => "swarm",
            Self::Teams => "teams",
            Self::Sweep => "sweep",
            Self::Line => "line",
            Self::Frontier => "frontier",
            Self::Relay => "relay",
            Self::Answer => "answer",
            Self::Charging => "charging",
            Self::Clean => "clean",
        }
    }

    /// Returns whether it steers by reports. Without them it is the same as another baseline.
    #[must_use]
    pub fn reads_reports(self) -> bool {
        self == Self::Answer
    }

    /// Returns whether it steers by the positions of hotspots that no UAV knows yet.
    #[must_use]
    pub fn reads_positions(self) -> bool {
        matches!(
            self,
            Self::Greedy | Self::Swarm | Self::Teams | Self::Charging | Self::Clean
        )
    }
}

impl fmt::Display for BaselineKind {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}
