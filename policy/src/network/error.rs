//! The errors of loading and running a network.

use core::fmt::{self, Write};

/// The name of an array in a file, such as `trunk.0.weight`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArrayName {
    pub(crate) stem: &'static str,
    pub(crate) layer: Option<usize>,
    pub(crate) part: &'static str,
}

impl fmt::Display for ArrayName {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.stem)?;
        if let Some(layer) = self.layer {
            let dot = if self.stem.is_empty() { "" } else { "." };
            write!(out, "{dot}{layer}")?;
        }
        if self.part.is_empty() {
            return Ok(());
        }
        write!(out, ".{}", self.part)
    }
}

/// A writer that strips each written text off the front of a text.
struct Remaining<'a>(&'a str);

impl Write for Remaining<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0 = self.0.strip_prefix(text).ok_or(fmt::Error)?;
        Ok(())
    }
}

impl ArrayName {
    /// Returns whether a text is this name.
    pub(crate) fn is(self, text: &str) -> bool {
        let mut remaining = Remaining(text);
        write!(remaining, "{self}").is_ok() && remaining.0.is_empty()
    }
}

/// A reason for which bytes do not hold a policy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LoadError {
    /// The file is shorter than its header states.
    Truncated,
    /// The header is not that of a safetensors file with a policy.
    Header(&'static str),
    /// The arrays form no known network.
    UnknownNetwork,
    /// An array is missing.
    Missing(ArrayName),
    /// The file has arrays that its network does not read.
    Surplus {
        /// Arrays in the file.
        count: usize,
        /// Arrays of the network.
        expected: usize,
    },
    /// An array's shape does not fit those before it.
    Shape {
        /// The array.
        array: ArrayName,
        /// Rows and columns that fit; 0 stands for any number.
        expected: [usize; 2],
        /// Its rows and columns.
        got: [usize; 2],
    },
    /// A weight is NaN or infinite, or a scale is not positive.
    Value {
        /// The array.
        array: ArrayName,
        /// Index of the element, row by row.
        index: usize,
    },
    /// The network has more layers than [`DEPTH_MAX`](super::DEPTH_MAX).
    Depth,
    /// The number of outputs fits no action head: 4 (gaussian) or 7 (hybrid).
    Outputs(usize),
    /// The entry `jcas` of the metadata is malformed.
    Metadata(&'static str),
    /// The memory for weights has the wrong size.
    Memory {
        /// Elements needed.
        expected: usize,
        /// Elements given.
        got: usize,
    },
}

impl fmt::Display for LoadError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Truncated => out.write_str("the file ends too early"),
            Self::Header(what) => write!(out, "header: {what}"),
            Self::UnknownNetwork => out.write_str(
                "arrays: must be those of an MLP (0.weight, …) or of a set network \
                 (hotspot.own, …)",
            ),
            Self::Missing(array) => write!(out, "array {array} is missing"),
            Self::Surplus { count, expected } => {
                write!(
                    out,
                    "arrays: {count}, of which the network reads {expected}"
                )
            }
            Self::Shape {
                array,
                expected,
                got,
            } => {
                let [rows, columns] = got;
                write!(out, "array {array}: shape {rows} × {columns}, must be ")?;
                match expected {
                    [0, 0] => out.write_str("not empty and at most 65536 wide"),
                    [0, columns] => write!(out, "any × {columns}"),
                    [rows, 0] => write!(out, "{rows} × any"),
                    [rows, columns] => write!(out, "{rows} × {columns}"),
                }
            }
            Self::Value { array, index } => {
                write!(
                    out,
                    "array {array}: element {index} is not finite, or a scale not positive"
                )
            }
            Self::Depth => out.write_str("layers: must be at most 8"),
            Self::Outputs(count) => {
                write!(out, "outputs: {count}, must be 4 (gaussian) or 7 (hybrid)")
            }
            Self::Metadata(what) => write!(out, "metadata: {what}"),
            Self::Memory { expected, got } => {
                write!(out, "memory: {got} elements, must be {expected}")
            }
        }
    }
}

impl core::error::Error for LoadError {}

/// A reason for which a policy cannot act in an episode of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FlyError {
    /// The policy reads other observations than those of the model.
    Observation {
        /// Fields that the policy reads. For an MLP these are all fields, and for a set network
        /// those beside hotspots and neighbours.
        expected: usize,
        /// Fields of that kind in the model.
        got: usize,
    },
    /// The policy was trained with hotspots hidden and the model shows them, or the reverse.
    Visibility,
    /// A buffer has the wrong length.
    Length {
        /// The name of the buffer.
        what: &'static str,
        /// Elements needed.
        expected: usize,
        /// Elements given.
        got: usize,
    },
    /// The network's outputs for a UAV are not finite.
    NotFinite {
        /// Index of the UAV.
        uav: usize,
    },
}

impl fmt::Display for FlyError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Observation { expected, got } => write!(
                out,
                "observation: the policy reads {expected} fields where this mission has {got}"
            ),
            Self::Visibility => {
                out.write_str("target_visibility: the policy was trained with the other value")
            }
            Self::Length {
                what,
                expected,
                got,
            } => write!(out, "{what}: {got} elements, must be {expected}"),
            Self::NotFinite { uav } => {
                write!(out, "the outputs for UAV {uav} are no finite numbers")
            }
        }
    }
}

impl core::error::Error for FlyError {}
