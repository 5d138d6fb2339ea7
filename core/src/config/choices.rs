//! The enumerations of the fields that choose between alternatives.

use core::fmt;
use core::str::FromStr;

/// Error for a name that is none of the alternatives.
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
    ($(#[$meta:meta])* $name:ident, $allowed:literal {
        $( $(#[$variant_meta:meta])* $variant:ident = $text:literal, )+
    }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub enum $name {
            $(
                $(#[$variant_meta])*
                #[cfg_attr(feature = "serde", serde(rename = $text))]
                $variant,
            )+
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

        /// The first alternative.
        impl Default for $name {
            fn default() -> Self {
                Self::ALL[0]
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
    /// A preset: a named set of values for every field.
    Preset, "`mission`, `paper`, `search` or `isac`" {
        /// The paper's model with its billing and payment corrected; the default.
        Mission = "mission",
        /// The paper's model, with every equation taken literally.
        Paper = "paper",
        /// A search: hotspots are hidden, radar has a long range, and UAVs share their search maps.
        Search = "search",
        /// A search in which sensing and communicating compete: coherent pilots, a Swerling-1 echo,
        /// false alarms and reports.
        Isac = "isac",
    }
}

choice! {
    /// Visibility, for a UAV, of the hotspots that it does not know.
    TargetVisibility, "`known` or `hidden`" {
        /// UAVs see the position of every hotspot, as in the paper.
        Known = "known",
        /// A UAV sees only the positions of hotspots that it knows.
        Hidden = "hidden",
    }
}

choice! {
    /// The energy that charging bills to the grid.
    ChargeBilling, "`accepted` or `nameplate`" {
        /// The energy that the battery accepted.
        Accepted = "accepted",
        /// The charger's rated energy for each step of a UAV on a depot.
        Nameplate = "nameplate",
    }
}

choice! {
    /// The steps at which an informed hotspot pays its reward.
    InformPayment, "`once` or `every_step`" {
        /// The step at which it becomes informed.
        Once = "once",
        /// That step and every later one.
        EveryStep = "every_step",
    }
}

choice! {
    /// Whether each UAV keeps a map of the cells that it knows to have been searched.
    SearchMaps, "`off` or `shared`" {
        /// UAVs keep no maps.
        Off = "off",
        /// Each UAV keeps a map; maps spread over the radio graph with knowledge.
        Shared = "shared",
    }
}

choice! {
    /// Whether an observation has the unsearched fraction in each of eight directions.
    MapDirections, "`off` or `shown`" {
        /// The observation has no such entries.
        Off = "off",
        /// The observation has eight such entries.
        Shown = "shown",
    }
}

choice! {
    /// The entry of an observation that distinguishes UAVs in one cell.
    UavTag, "`off` or `index`" {
        /// The observation has no such entry.
        Off = "off",
        /// The entry is i/(N - 1) for UAV i.
        Index = "index",
    }
}

choice! {
    /// What the pilot density adds to the sensing SNR.
    PilotGain, "`none` or `coherent`" {
        /// Nothing, as in the paper.
        None = "none",
        /// 10 log10(ρ/ρ_max) dB: the radar integrates the pilots coherently.
        Coherent = "coherent",
    }
}

choice! {
    /// The positive detections of a hotspot that count toward its quorum.
    QuorumWindow, "`step` or `episode`" {
        /// Those of the present step, as in the paper.
        Step = "step",
        /// Those of the episode so far, one from each UAV.
        Episode = "episode",
    }
}

choice! {
    /// The hotspots that a UAV learns by its own detection.
    LearnedDetections, "`confirmed` or `all`" {
        /// Those that a quorum has confirmed.
        Confirmed = "confirmed",
        /// All, confirmed or not.
        All = "all",
    }
}

choice! {
    /// The cells in which UAVs start an episode.
    StartCells, "`depot` or `random`" {
        /// The first depot.
        Depot = "depot",
        /// Any cell of the grid, drawn for each UAV.
        Random = "random",
    }
}

choice! {
    /// The order of the five motions over the bins of u_dir.
    MotionMap, "`udlrs` or `symmetric`" {
        /// Up, down, left, right, stay.
        Udlrs = "udlrs",
        /// Up, left, stay, right, down: opposite motions in opposite bins. Draws that are symmetric
        /// about 0 have no mean motion.
        Symmetric = "symmetric",
    }
}

choice! {
    /// The curve that gives the probability of detection over the sensing SNR.
    DetectionCurve, "`logistic`, `swerling1` or `table`" {
        /// The paper's logistic function of the margin above the threshold.
        Logistic = "logistic",
        /// A Swerling-1 echo behind a square-law detector, in one look.
        Swerling1 = "swerling1",
        /// A table over the range, whose logit pilot gain and load penalty move by κ per dB.
        Table = "table",
    }
}
