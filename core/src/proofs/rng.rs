//! P9: no counter is used twice, and uniform draws stay in their range.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::words::rng::{Purpose, below, counter, unit};

fn any_purpose() -> Purpose {
    match between(1, 7) {
        1 => Purpose::Detect,
        2 => Purpose::Carbon,
        3 => Purpose::InitialSoc,
        4 => Purpose::Hotspot,
        5 => Purpose::Shuffle,
        6 => Purpose::Seed,
        _ => Purpose::Policy,
    }
}

/// Two draws that differ in anything have counters that differ in some word.
fn is_injective(a: (u32, u32, u32, Purpose), b: (u32, u32, u32, Purpose)) {
    let one = counter(a.0, a.1, a.2, a.3);
    let other = counter(b.0, b.1, b.2, b.3);
    let same_draw = a.0 == b.0 && a.1 == b.1 && a.2 == b.2 && a.3 as u32 == b.3 as u32;
    let same_counter =
        one[0] == other[0] && one[1] == other[1] && one[2] == other[2] && one[3] == other[3];
    assert!(same_draw == same_counter);
}

#[cfg_attr(kani, kani::proof)]
pub fn no_counter_is_used_twice() {
    let a = (kani::any(), kani::any(), kani::any(), any_purpose());
    // One field in four is taken over, so that near misses are as likely as not.
    let b = (
        if kani::any() { a.0 } else { kani::any() },
        if kani::any() { a.1 } else { kani::any() },
        if kani::any() { a.2 } else { kani::any() },
        if kani::any() { a.3 } else { any_purpose() },
    );
    kani::cover!(
        a.0 == b.0 && a.1 == b.1 && a.2 == b.2 && a.3 != b.3,
        "differ in purpose only"
    );
    kani::cover!(
        a.0 != b.0 && a.1 == b.1 && a.2 == b.2 && a.3 == b.3,
        "differ in step only"
    );
    is_injective(a, b);
}

/// In [0, 1) for any 64 bits.
fn is_a_unit_real(bits: u64) {
    let real = unit(bits);
    assert!(real >= 0.0 && real < 1.0);
}

#[cfg_attr(kani, kani::proof)]
pub fn uniform_reals_are_below_one() {
    let bits: u64 = kani::any();
    kani::cover!(bits == u64::MAX, "the largest draw");
    kani::cover!(unit(bits) == 0.0, "zero");
    is_a_unit_real(bits);
}

/// Below the bound for any 64 bits.
fn is_below(bits: u64, count: u64) {
    assert!(below(bits, count) < count);
}

/// Rows of the multiplier that the solver has to reason about.
const COUNT_MAX: u64 = 4096;

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn uniform_integers_are_below_their_count() {
    let bits: u64 = kani::any();
    let count = between(1, COUNT_MAX);
    kani::cover!(
        below(bits, count) + 1 == count && count > 1,
        "the largest value"
    );
    kani::cover!(below(bits, count) == 0 && count > 1, "the smallest value");
    is_below(bits, count);
}

#[cfg(not(kani))]
super::standin::twins! {
    no_counter_is_used_twice: 2000 cases, 2 covers;
    uniform_reals_are_below_one: 2000 cases, 2 covers;
    uniform_integers_are_below_their_count: 4000 cases, 2 covers;
}

#[cfg(test)]
mod wide {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The same for every count that a `u64` holds.
        #[test]
        fn uniform_integers_are_below_their_count(bits: u64, count in 1..=u64::MAX) {
            is_below(bits, count);
        }
    }
}
