//! How a real is kept in a word of a state.

/// Bits of a real as the state stores it: never a negative zero.
#[inline]
pub(crate) fn stored(value: f64) -> u64 {
    (value + 0.0).to_bits()
}
