//! The fields that choose between alternatives.

use core::fmt;
use core::str::FromStr;

/// A name that none of the alternatives has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownName {
    /// What would have been accepted.
    pub allowed: &'static str,
}

impl fmt::Display for UnknownName {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "must be {}", self.allowed)
    }
}

impl core::error::Error for UnknownName {}

/// Declares an enumeration whose names are the same in files, messages and on the command line.
macro_rules! choice {
    ($(#[$meta:meta])* $name:ident, $allowed:literal { $( $(#[$variant_meta:meta])* $variant:ident = $text:literal, )+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub enum $name {
            $( $(#[$variant_meta])* #[cfg_attr(feature = "serde", serde(rename = $text))] $variant, )+
        }

        impl $name {
            /// Every alternative, in order.
            pub const ALL: &'static [Self] = &[$( Self::$variant ),+];

            /// Its name in files and on the command line.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $( Self::$variant => $text, )+ }
            }

            /// The alternative with the given index in [`Self::ALL`].
            #[must_use]
            pub fn from_index(index: u32) -> Option<Self> {
                Self::ALL.get(index as usize).copied()
            }
        }

        impl FromStr for $name {
            type Err = UnknownName;
            fn from_str(text: &str) -> Result<Self, UnknownName> {
                match text {
                    $( $text => Ok(Self::$variant), )+
                    _ => Err(UnknownName { allowed: $allowed }),
                }
            }
        }
    };
}

choice! {
    /// A named set of values for every field.
    Preset, "`mission`, `paper` or `search`" {
        /// The paper with its billing and payment corrected; the default.
        Mission = "mission",
        /// The letter of every equation of the paper.
        Paper = "paper",
        /// Hidden hotspots that radar reaches from afar; UAVs share what they have looked at.
        Search = "search",
    }
}

choice! {
    /// What UAVs see of hotspots that they do not know.
    TargetVisibility, "`known` or `hidden`" {
        /// Every hotspot's position, as in the paper.
        Known = "known",
        /// Positions only of hotspots that the UAV knows.
        Hidden = "hidden",
    }
}

choice! {
    /// What charging bills to the grid.
    ChargeBilling, "`accepted` or `nameplate`" {
        /// What the battery accepted.
        Accepted = "accepted",
        /// The charger's rating whenever a UAV is on a depot.
        Nameplate = "nameplate",
    }
}

choice! {
    /// When an informed hotspot pays its reward.
    InformPayment, "`once` or `every_step`" {
        /// At the step at which it becomes informed.
        Once = "once",
        /// At that step and every later one.
        EveryStep = "every_step",
    }
}

choice! {
    /// Whether each UAV keeps a map of the cells that it knows to have been looked at.
    SearchMaps, "`off` or `shared`" {
        /// No maps.
        Off = "off",
        /// A map per UAV; maps spread with knowledge.
        Shared = "shared",
    }
}

choice! {
    /// Whether an observation tells how much is unsearched in each of eight directions.
    MapDirections, "`off` or `shown`" {
        /// It does not.
        Off = "off",
        /// It does.
        Shown = "shown",
    }
}

choice! {
    /// What tells UAVs in one cell apart.
    UavTag, "`off` or `index`" {
        /// Nothing.
        Off = "off",
        /// i/(N - 1).
        Index = "index",
    }
}
