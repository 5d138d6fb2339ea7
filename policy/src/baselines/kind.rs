//! The names of the baselines.

use core::fmt;

/// Declares the baselines once, each with its name.
macro_rules! baselines {
    ($( $(#[$meta:meta])+ $kind:ident = $name:literal, )+) => {
        /// A baseline by name.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum BaselineKind {
            $( $(#[$meta])+ $kind, )+
        }

        impl BaselineKind {
            /// All baselines.
            pub const ALL: [Self; [$( $name ),+].len()] = [$( Self::$kind ),+];

            /// The name of the baseline.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $( Self::$kind => $name, )+
                }
            }
        }
    };
}

baselines! {
    /// [`Random`](super::Random).
    Random = "random",
    /// [`Untrained`](super::Untrained).
    Untrained = "untrained",
    /// [`Greedy`](super::Greedy).
    Greedy = "greedy",
    /// [`Swarm`](super::Swarm).
    Swarm = "swarm",
    /// [`Teams`](super::Teams).
    Teams = "teams",
    /// [`Squads`](super::Squads).
    Squads = "squads",
    /// [`Sweep`](super::Sweep).
    Sweep = "sweep",
    /// [`Line`](super::Line).
    Line = "line",
    /// [`Frontier`](super::Frontier).
    Frontier = "frontier",
    /// [`Frontier::connected`](super::Frontier::connected).
    Relay = "relay",
    /// [`Answer`](super::Answer).
    Answer = "answer",
    /// [`Charging::greedy`](super::Charging::greedy).
    Charging = "charging",
    /// [`Charging::clean`](super::Charging::clean).
    Clean = "clean",
}

impl BaselineKind {
    /// Returns whether it steers by reports. Without them it is the same as another baseline.
    #[must_use]
    pub fn reads_reports(self) -> bool {
        self == Self::Answer
    }

    /// Returns whether its motions depend on nothing but draws.
    #[must_use]
    pub(super) fn is_random(self) -> bool {
        matches!(self, Self::Random | Self::Untrained)
    }

    /// Returns whether all UAVs gather once every hotspot is confirmed, also those that do not know
    /// it.
    #[must_use]
    pub(super) fn gathers(self) -> bool {
        self != Self::Squads && !self.is_random()
    }

    /// Returns whether it steers by the positions of hotspots that no UAV knows yet.
    #[must_use]
    pub fn reads_positions(self) -> bool {
        matches!(
            self,
            Self::Greedy | Self::Swarm | Self::Teams | Self::Squads | Self::Charging | Self::Clean
        )
    }
}

impl fmt::Display for BaselineKind {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}
