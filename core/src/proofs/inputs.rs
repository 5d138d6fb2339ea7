//! Inputs within bounds, the same for Kani and for its stand-in.
//!
//! Kani narrows with `assume`. The stand-in maps the tape into the bounds instead,
//! so that no tape is wasted.

#[cfg(not(kani))]
use super::standin as kani;

/// Any integer in `low..=high`.
#[cfg(kani)]
pub fn between(low: u64, high: u64) -> u64 {
    let value: u64 = kani::any();
    kani::assume(value >= low && value <= high);
    value
}

/// Any integer in `low..=high`; the bounds themselves more often than chance.
#[cfg(not(kani))]
pub fn between(low: u64, high: u64) -> u64 {
    let word: u64 = kani::any();
    match word % 16 {
        0 => low,
        1 => high,
        _ if high - low == u64::MAX => word,
        _ => low + (word / 16) % (high - low + 1),
    }
}

/// Any real in `low..=high`.
#[cfg(kani)]
pub fn real_between(low: f64, high: f64) -> f64 {
    let value: f64 = kani::any();
    kani::assume(value >= low && value <= high);
    value
}

/// Any real in `low..=high`; the bounds themselves more often than chance.
#[cfg(not(kani))]
pub fn real_between(low: f64, high: f64) -> f64 {
    let word: u64 = kani::any();
    match word % 16 {
        0 => low,
        1 => high,
        _ => {
            let unit = (word >> 11) as f64 / (1u64 << 53) as f64;
            let value = low + (high - low) * unit;
            if value > high { high } else { value }
        }
    }
}

/// Whether `sum` is not below its part: once a sum is not a number, it stays so.
// A negated comparison is true of a NaN, which it must be here.
#[allow(clippy::neg_cmp_op_on_partial_ord)]
pub(super) fn does_not_fall(at_most: f64, sum: f64) -> bool {
    !(sum < at_most) && (!at_most.is_nan() || sum.is_nan())
}
