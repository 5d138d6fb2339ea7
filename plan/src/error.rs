//! The errors of making a plan.

use core::fmt;

use jcas_policy::MemoryError;

/// A reason for which a plan cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlanError {
    /// The fleet has more UAVs than a plan can hold.
    TooManyUavs {
        /// Number of UAVs of the fleet.
        uavs: usize,
        /// The maximum number of UAVs of a plan.
        most: usize,
    },
    /// The episode has more hotspots than a plan can visit.
    TooManyHotspots {
        /// Number of hotspots of the episode.
        hotspots: usize,
        /// The maximum number of hotspots of a plan.
        most: usize,
    },
    /// The horizon is too long for the number of cells that may hold a hotspot.
    TooLong {
        /// Steps of the horizon.
        horizon_steps: u32,
        /// The maximum number of steps for these cells.
        most: usize,
    },
    /// The plan needs a larger table than is allowed.
    TooLarge {
        /// Number of entries of the largest table.
        entries: usize,
        /// The maximum number of entries.
        most: usize,
    },
    /// The system has no memory for the plan.
    OutOfMemory {
        /// The most bytes that making the plan can take.
        bytes: u64,
    },
    /// A length does not fit the model.
    Length {
        /// The name of the list.
        what: &'static str,
        /// The length that fits.
        expected: usize,
        /// The length given.
        got: usize,
    },
    /// A field of the configuration has a value that plans do not cover.
    Configuration {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: &'static str,
        /// The value that plans cover.
        allowed: &'static str,
    },
    /// The policy remembers another state than the one before.
    Memory(MemoryError),
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
            Self::TooManyHotspots { hotspots, most } => write!(
                out,
                "hotspot_count = {hotspots}: a plan holds at most {most} hotspots"
            ),
            Self::TooLong {
                horizon_steps,
                most,
            } => write!(
                out,
                "horizon_steps = {horizon_steps}: a plan over these cells covers at most {most} \
                 steps"
            ),
            Self::TooLarge { entries, most } => write!(
                out,
                "the plan needs a table of {entries} entries; at most {most} are allowed"
            ),
            Self::OutOfMemory { bytes } => write!(
                out,
                "planning may take {bytes} bytes of memory, which could not be had"
            ),
            Self::Length {
                what,
                expected,
                got,
            } => write!(out, "{what}: must have length {expected}, not {got}"),
            Self::Configuration {
                field,
                value,
                allowed,
            } => write!(out, "{field} = {value}: a plan needs {allowed}"),
            Self::Memory(error) => error.fmt(out),
            Self::Weights => out
                .write_str("the weights of a prior must be finite, not negative and not all zero"),
            Self::OffGrid { x, y } => write!(out, "cell [{x}, {y}] lies off the grid"),
        }
    }
}

impl core::error::Error for PlanError {}

impl From<MemoryError> for PlanError {
    fn from(error: MemoryError) -> Self {
        Self::Memory(error)
    }
}
