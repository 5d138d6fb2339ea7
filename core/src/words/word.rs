//! The form in which a state stores a real in a word.

/// Bits of a real as a state stores it: a negative zero becomes zero.
#[inline]
pub(crate) fn canonical_bits(value: f64) -> u64 {
    (value + 0.0).to_bits()
}
