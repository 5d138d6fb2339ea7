//! The names of policies, each with what it does. Commands, messages, pages and other languages
//! list policies from here.

use core::fmt;

use jcas_core::{Config, TargetVisibility};

/// A policy that goes by a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NamedPolicy {
    /// Its name.
    pub name: &'static str,
    /// What it does, in a few words.
    pub summary: &'static str,
}

/// Declares the baselines once, each with its name and what it does.
macro_rules! baselines {
    ($( $(#[$meta:meta])+ $kind:ident = $name:literal, $summary:literal; )+) => {
        /// A baseline by name.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum BaselineKind {
            $( $(#[$meta])+ $kind, )+
        }

        impl BaselineKind {
            /// All baselines.
            pub const ALL: [Self; [$( $name ),+].len()] = [$( Self::$kind ),+];

            /// The name of the baseline, and what it does.
            #[must_use]
            pub const fn named_policy(self) -> NamedPolicy {
                match self {
                    $( Self::$kind => NamedPolicy { name: $name, summary: $summary }, )+
                }
            }
        }
    };
}

baselines! {
    /// A random walk.
    Random = "random", "a pure random walk: five equally likely motions";
    /// Draws of a network before its training.
    Untrained = "untrained", "a network before its training: clipped normal draws";
    /// Every UAV for itself.
    Greedy = "greedy", "each UAV flies to the unconfirmed hotspot nearest to itself";
    /// Teams of the whole fleet.
    Teams = "teams", "teams of at least the quorum divide the hotspots among them";
    /// Teams within each radio component.
    Squads = "squads", "teams within each radio component, by what its members know";
    /// A search for hidden hotspots.
    Line = "line", "lines abreast sweep the grid for hidden hotspots";
    /// A search that follows reports.
    Answer = "answer", "as line, but a quorum of UAVs flies to each reported cell";
}

/// The policy that follows one plan.
pub const PLAN: NamedPolicy = NamedPolicy {
    name: "plan",
    summary: "one annealed plan, followed without feedback",
};

/// The policy that plans anew.
pub const REPLAN: NamedPolicy = NamedPolicy {
    name: "replan",
    summary: "a plan made anew after each confirmation, meeting and report",
};

/// Returns all policies that go by a name: the baselines, then those that plan.
pub fn named_policies() -> impl Iterator<Item = NamedPolicy> {
    let baselines = BaselineKind::ALL.into_iter();
    baselines
        .map(BaselineKind::named_policy)
        .chain([PLAN, REPLAN])
}

/// A text with the names of all policies, separated by commas.
#[derive(Clone, Copy, Debug)]
pub struct PolicyNames;

impl fmt::Display for PolicyNames {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        list(out, named_policies().map(|policy| policy.name))
    }
}

/// Writes names, separated by commas.
pub(crate) fn list<'n>(
    out: &mut fmt::Formatter<'_>,
    names: impl Iterator<Item = &'n str>,
) -> fmt::Result {
    for (index, name) in names.enumerate() {
        out.write_str(if index > 0 { ", " } else { "" })?;
        out.write_str(name)?;
    }
    Ok(())
}

impl BaselineKind {
    /// The name of the baseline.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.named_policy().name
    }

    /// Returns the baseline that flies a configuration unless another one is named: the fastest one
    /// that steers by nothing that is hidden.
    #[must_use]
    pub const fn default_for(config: &Config) -> Self {
        match config.target_visibility {
            TargetVisibility::Known => Self::Teams,
            TargetVisibility::Hidden if config.report_levels > 0 => Self::Answer,
            TargetVisibility::Hidden => Self::Line,
        }
    }

    /// Returns whether it steers by reports. Without them it is the same as another baseline.
    #[must_use]
    pub const fn reads_reports(self) -> bool {
        matches!(self, Self::Answer)
    }

    /// Returns whether it steers by the positions of hotspots that no UAV knows yet.
    #[must_use]
    pub const fn reads_positions(self) -> bool {
        matches!(self, Self::Greedy | Self::Teams | Self::Squads)
    }

    /// Returns whether its motions depend on nothing but draws.
    #[cfg(feature = "baselines")]
    pub(crate) const fn is_random(self) -> bool {
        matches!(self, Self::Random | Self::Untrained)
    }

    /// Returns whether its motions depend on what it did before.
    #[cfg(feature = "baselines")]
    pub(crate) const fn remembers(self) -> bool {
        matches!(self, Self::Teams | Self::Squads | Self::Line | Self::Answer)
    }

    /// Returns whether all UAVs gather once every hotspot is confirmed, also those that do not know
    /// it.
    #[cfg(feature = "baselines")]
    pub(crate) const fn gathers(self) -> bool {
        !matches!(self, Self::Squads) && !self.is_random()
    }
}

impl fmt::Display for BaselineKind {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use jcas_core::Preset;

    use super::*;

    #[test]
    fn each_preset_flies_a_baseline_that_reads_nothing_hidden() {
        let default = |preset| BaselineKind::default_for(&Config::preset(preset));
        for &preset in Preset::ALL {
            let hidden = Config::preset(preset).target_visibility == TargetVisibility::Hidden;
            assert!(!(hidden && default(preset).reads_positions()));
        }
        assert_eq!(default(Preset::Paper), BaselineKind::Teams);
        assert_eq!(default(Preset::Search), BaselineKind::Line);
        assert_eq!(default(Preset::Isac), BaselineKind::Answer);
    }

    #[test]
    fn every_name_is_its_own() {
        for policy in named_policies() {
            let same = named_policies().filter(|other| other.name == policy.name);
            assert_eq!(same.count(), 1, "{}", policy.name);
            assert!(!policy.summary.is_empty());
        }
    }
}
