//! Fields of the configuration seen alike, for checks, listings and fingerprints.

use super::{
    ChargeBilling, Config, Depots, InformPayment, MapDirections, SearchMaps, TargetVisibility,
    UavTag,
};
use crate::error::Value;
use crate::hash::Fnv1a;

/// Description of a field.
#[derive(Clone, Copy, Debug)]
pub struct FieldInfo {
    /// Its name, the same in files, on the command line and in C.
    pub name: &'static str,
    /// Its unit, or its alternatives.
    pub unit: &'static str,
    /// Lowest legal value.
    pub low: f64,
    /// Highest legal value.
    pub high: f64,
    /// What it means, with the paper's symbol.
    pub doc: &'static str,
}

/// The value of a field, whatever its type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldValue {
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
}

/// The values of all fields.
pub type FieldValues = [FieldValue; Config::FIELD_COUNT];

impl FieldValue {
    /// Adds the value to a fingerprint.
    pub(super) fn write(&self, hash: &mut Fnv1a) {
        match self {
            Self::Integer(value) | Self::Choice(_, value) => hash.write_u64(u64::from(*value)),
            Self::Real(value) => hash.write_u64(value.to_bits()),
            Self::Optional(Some(value)) => {
                hash.write_u64(1);
                hash.write_u64(value.to_bits());
            }
            Self::Optional(None) => hash.write_u64(0),
            Self::Cells(cells) => {
                hash.write_u64(cells.len() as u64);
                for cell in cells.as_slice() {
                    hash.write_u64(cell.to_word());
                }
            }
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
pub(super) trait Field {
    fn field_value(&self) -> FieldValue;
    #[cfg_attr(not(feature = "serde"), allow(dead_code))]
    fn is_derived(&self) -> bool {
        false
    }
}

impl Field for u32 {
    fn field_value(&self) -> FieldValue {
        FieldValue::Integer(*self)
    }
}

impl Field for f64 {
    fn field_value(&self) -> FieldValue {
        FieldValue::Real(*self)
    }
}

impl Field for Option<f64> {
    fn field_value(&self) -> FieldValue {
        FieldValue::Optional(*self)
    }
    fn is_derived(&self) -> bool {
        self.is_none()
    }
}

impl Field for Depots {
    fn field_value(&self) -> FieldValue {
        FieldValue::Cells(*self)
    }
    fn is_derived(&self) -> bool {
        self.is_empty()
    }
}

macro_rules! choice_field {
    ($($name:ident),+) => { $(
        impl Field for $name {
            fn field_value(&self) -> FieldValue {
                FieldValue::Choice(self.name(), *self as u32)
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
    UavTag
);
