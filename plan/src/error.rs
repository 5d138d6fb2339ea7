//! Why a plan cannot be made.

use core::fmt;

/// Why a plan cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlanError {
    /// The fleet has more UAVs than a plan can hold.
    TooManyUavs {
        /// UAVs of the fleet.
        uavs: usize,
        /// UAVs that a plan can hold.
        most: usize,
    },
    /// The plan would take more memory than is allowed.
    TooLarge {
        /// Entries of the largest table.
        entries: usize,
        /// Entries that are allowed.
        most: usize,
    },
    /// A length does not fit the model.
    Length {
        /// What has the wrong length.
        what: &'static str,
        /// The length that fits.
        expected: usize,
        /// The length given.
        got: usize,
    },
    /// A weight of a prior is negative or not finite, or all are zero.
    Weights,
    /// A cell lies off the grid.
    OffGrid {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
}

impl fmt::Display for PlanError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooManyUavs { uavs, most } => {
                write!(out, "uav_count = {uavs}: a plan holds at most {most} UAVs")
            }
            Self::TooLarge { entries, most } => write!(
                out,
                "the plan needs a table of {entries} entries; at most {most} are allowed"
            ),
            Self::Length {
                what,
                expected,
                got,
            } => write!(out, "{what}: must have length {expected}, not {got}"),
            Self::Weights => out
                .write_str("the weights of a prior must be finite, not negative and not all zero"),
            Self::OffGrid { x, y } => write!(out, "cell [{x}, {y}] lies off the grid"),
        }
    }
}

impl core::error::Error for PlanError {}
