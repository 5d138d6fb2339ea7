//! Fields of the configuration seen alike, for checks, listings and fingerprints.

use core::fmt;

#[cfg(feature = "text")]
use super::text::TextValue;
use super::{
    ChargeBilling, Config, Depots, DetectionCurve, DetectionTable, InformPayment,
    LearnedDetections, MapDirections, MotionMap, PilotGain, QuorumWindow, SearchMaps, StartCells,
    TargetVisibility, UavTag,
};
use crate::error::Value;
use crate::words::hash::Fnv1a;

/// Description of a field.
#[derive(Clone, Copy, Debug)]
pub struct FieldInfo {
    /// Name of the field, the same in files, on the command line and in C.
    pub name: &'static str,
    /// Unit of the field, or its alternatives.
    pub unit: &'static str,
    /// Lowest legal value.
    pub low: f64,
    /// Highest legal value.
    pub high: f64,
    /// Meaning of the field, with the paper's symbol.
    pub doc: &'static str,
}

/// The value of a field of any type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldValue<'c> {
    /// A count.
    Integer(u32),
    /// A real number.
    Real(f64),
    /// A real number, or derived from other fields.
    Optional(Option<f64>),
    /// One of several names, with its index.
    Choice(&'static str, u32),
    /// A list of cells.
    Cells(Depots),
    /// A table over the range.
    Table(&'c DetectionTable),
}

/// Formats the value as TOML and JSON write it. A derived value, which neither writes, is empty.
impl fmt::Display for FieldValue<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(value) => write!(out, "{value}"),
            Self::Real(value) | Self::Optional(Some(value)) => write!(out, "{value:?}"),
            Self::Optional(None) => Ok(()),
            Self::Choice(name, _) => write!(out, "\"{name}\""),
            Self::Cells(cells) => {
                out.write_str("[")?;
                for (index, cell) in cells.as_slice().iter().enumerate() {
                    out.write_str(if index > 0 { "," } else { "" })?;
                    write!(out, "[{},{}]", cell.x, cell.y)?;
                }
                out.write_str("]")
            }
            Self::Table(table) => {
                out.write_str("[")?;
                for (index, point) in table.as_slice().iter().enumerate() {
                    out.write_str(if index > 0 { "," } else { "" })?;
                    write!(out, "[{:?},{:?}]", point.range_m, point.probability)?;
                }
                out.write_str("]")
            }
        }
    }
}

/// Serialises the value itself, without the kind.
#[cfg(feature = "serde")]
impl serde::Serialize for FieldValue<'_> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Integer(value) => value.serialize(serializer),
            Self::Real(value) => value.serialize(serializer),
            Self::Optional(value) => value.serialize(serializer),
            Self::Choice(name, _) => name.serialize(serializer),
            Self::Cells(cells) => cells.serialize(serializer),
            Self::Table(table) => table.serialize(serializer),
        }
    }
}

/// The values of all fields.
pub type FieldValues<'c> = [FieldValue<'c>; Config::FIELD_COUNT];

impl FieldValue<'_> {
    /// Adds the value to a fingerprint.
    pub(super) fn write(&self, hash: &mut Fnv1a) {
        match self {
            Self::Integer(value) | Self::Choice(_, value) => hash.write_u64(u64::from(*value)),
            // The sign of a zero would make two equal configurations differ.
            Self::Real(value) => hash.write_u64((value + 0.0).to_bits()),
            Self::Optional(Some(value)) => {
                hash.write_u64(1);
                hash.write_u64((value + 0.0).to_bits());
            }
            Self::Optional(None) => hash.write_u64(0),
            Self::Cells(cells) => {
                hash.write_u64(cells.len() as u64);
                for cell in cells.as_slice() {
                    hash.write_u64(cell.to_word());
                }
            }
            Self::Table(table) => {
                hash.write_u64(table.len() as u64);
                for point in table.as_slice() {
                    hash.write_u64((point.range_m + 0.0).to_bits());
                    hash.write_u64(point.probability.to_bits());
                }
            }
        }
    }

    /// Whether the value is left to be derived from other fields.
    #[must_use]
    pub const fn is_derived(&self) -> bool {
        match self {
            Self::Optional(value) => value.is_none(),
            Self::Cells(cells) => cells.is_empty(),
            Self::Table(table) => table.is_empty(),
            _ => false,
        }
    }

    /// The value if it is outside the bounds (NaN always is).
    pub(super) fn outside(&self, low: f64, high: f64) -> Option<Value> {
        let beyond = |value: f64| !(value >= low && value <= high);
        match *self {
            Self::Integer(value) if beyond(f64::from(value)) => Some(Value::Integer(value.into())),
            Self::Real(value) | Self::Optional(Some(value)) if beyond(value) => {
                Some(Value::Real(value))
            }
            _ => None,
        }
    }
}

/// A type that a field can have.
pub(super) trait Field: Sized {
    fn field_value(&self) -> FieldValue<'_>;
    /// The value that a text gives; `None` if it is of another type.
    #[cfg(feature = "text")]
    fn read(value: &TextValue<'_>) -> Option<Self>;
}

impl Field for u32 {
    fn field_value(&self) -> FieldValue<'_> {
        FieldValue::Integer(*self)
    }
    #[cfg(feature = "text")]
    fn read(value: &TextValue<'_>) -> Option<Self> {
        value.whole()
    }
}

impl Field for f64 {
    fn field_value(&self) -> FieldValue<'_> {
        FieldValue::Real(*self)
    }
    #[cfg(feature = "text")]
    fn read(value: &TextValue<'_>) -> Option<Self> {
        value.real()
    }
}

impl Field for Option<f64> {
    fn field_value(&self) -> FieldValue<'_> {
        FieldValue::Optional(*self)
    }
    #[cfg(feature = "text")]
    fn read(value: &TextValue<'_>) -> Option<Self> {
        match value {
            TextValue::Null | TextValue::Name("none") => Some(None),
            _ => value.real().map(Some),
        }
    }
}

impl Field for Depots {
    fn field_value(&self) -> FieldValue<'_> {
        FieldValue::Cells(*self)
    }
    #[cfg(feature = "text")]
    fn read(value: &TextValue<'_>) -> Option<Self> {
        match *value {
            TextValue::Null => Some(Self::CENTRE),
            TextValue::Pairs(pairs) => pairs.cells(),
            _ => None,
        }
    }
}

impl Field for DetectionTable {
    fn field_value(&self) -> FieldValue<'_> {
        FieldValue::Table(self)
    }
    #[cfg(feature = "text")]
    fn read(value: &TextValue<'_>) -> Option<Self> {
        match *value {
            TextValue::Null => Some(Self::EMPTY),
            TextValue::Pairs(pairs) => pairs.table(),
            _ => None,
        }
    }
}

macro_rules! choice_field {
    ($($name:ident),+) => { $(
        impl Field for $name {
            fn field_value(&self) -> FieldValue<'_> {
                FieldValue::Choice(self.name(), *self as u32)
            }
            #[cfg(feature = "text")]
            fn read(value: &TextValue<'_>) -> Option<Self> {
                match value {
                    TextValue::Name(name) => name.parse().ok(),
                    _ => None,
                }
            }
        }
    )+ };
}
choice_field!(
    TargetVisibility,
    ChargeBilling,
    InformPayment,
    SearchMaps,
    MapDirections,
    UavTag,
    PilotGain,
    DetectionCurve,
    QuorumWindow,
    LearnedDetections,
    StartCells,
    MotionMap
);
