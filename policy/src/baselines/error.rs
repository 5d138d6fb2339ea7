//! The errors of building a baseline.

use core::fmt;

use jcas_core::Printable;

use crate::names::list;
use crate::{BaselineKind, PLAN, PolicyNames, REPLAN, named_policies};

/// The longest text, in bytes, that may have meant a name.
const SPELLED_BYTES_MAX: usize = 16;
/// The most letters that are added, left out or replaced in a name that was meant.
const EDITS_MAX: usize = 2;

/// Returns the name of a policy that is spelled like another text, in any case of its letters.
#[must_use]
pub fn similar(name: &str) -> Option<&'static str> {
    let names = named_policies().map(|policy| policy.name);
    let nearest = names.min_by_key(|policy| edits(name, policy))?;
    // Half of the letters and more are another word.
    let most = EDITS_MAX.min((name.len().max(1) - 1) / 2);
    (edits(name, nearest) <= most).then_some(nearest)
}

/// The edit distance of Levenshtein, without an allocation: a refusal must not need memory.
fn edits(text: &str, name: &str) -> usize {
    if text.len() > SPELLED_BYTES_MAX {
        return usize::MAX;
    }
    let mut row: [usize; SPELLED_BYTES_MAX + 1] = core::array::from_fn(|column| column);
    for (line, letter) in name.bytes().enumerate() {
        let mut diagonal = row[0];
        row[0] = line + 1;
        for (column, given) in text.bytes().enumerate() {
            let replaced = diagonal + usize::from(!given.eq_ignore_ascii_case(&letter));
            diagonal = row[column + 1];
            row[column + 1] = replaced.min(diagonal + 1).min(row[column] + 1);
        }
    }
    row[text.len()]
}

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
            Self::UnknownPolicy(name) => {
                write!(
                    out,
                    "policy = {}: must be one of {PolicyNames}",
                    Printable(name)
                )?;
                match similar(name) {
                    Some(near) => write!(out, "; did you mean {near}?"),
                    None => Ok(()),
                }
            }
            Self::UnknownPilot(name) => write!(
                out,
                "pilot = {}: must be one of min, mid, max, adaptive, or a density such as 0.15",
                Printable(name)
            ),
            Self::PilotOutOfRange { density, low, high } => write!(
                out,
                "pilot = {density}: must be a density from {low} (pilot_density_min) to {high} \
                 (pilot_density_max)"
            ),
            Self::Hidden(kind) => {
                write!(
                    out,
                    "policy = {kind}: steers by positions that target_visibility = hidden \
                     withholds; must be one of "
                )?;
                let searching = BaselineKind::ALL
                    .into_iter()
                    .filter(|kind| !kind.reads_positions());
                let searching = searching.map(BaselineKind::name);
                list(out, searching.chain([PLAN.name, REPLAN.name]))
            }
        }
    }
}

impl std::error::Error for PolicyError<'_> {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_is_nearly_right_is_suggested() {
        for (given, meant) in [
            ("Teams", Some("teams")),
            ("tems", Some("teams")),
            ("squad", Some("squads")),
            ("re-plan", Some("replan")),
            ("PLAN", Some("plan")),
            ("clever", None),
            ("", None),
        ] {
            assert_eq!(similar(given), meant, "{given}");
        }
        let refusal = PolicyError::UnknownPolicy("tems").to_string();
        assert_eq!(
            refusal,
            "policy = tems: must be one of random, untrained, greedy, teams, squads, line, answer, \
             plan, replan; did you mean teams?"
        );
        let refusal = PolicyError::Hidden(BaselineKind::Teams).to_string();
        let allowed = "must be one of random, untrained, line, answer, plan, replan";
        assert!(refusal.ends_with(allowed), "{refusal}");
    }
}
