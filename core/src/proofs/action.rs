//! P1 and P2: clipping is total, and a pilot density stays in its range.

use super::inputs::real_between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::config::MotionMap;
use crate::rules::action::{clip, motion, pilot_density};

/// A clipped value lies in [-1, 1] for any bits, and a value inside does not change.
fn clips(value: f32) {
    let clipped = clip(value);
    assert!(clipped >= -1.0 && clipped <= 1.0);
    if value >= -1.0 && value <= 1.0 {
        assert!(clipped == value);
    }
}

#[cfg_attr(kani, kani::proof)]
pub fn clip_is_total() {
    let value: f32 = kani::any();
    kani::cover!(value > 1.0, "clipped from above");
    kani::cover!(value < -1.0, "clipped from below");
    kani::cover!(value.is_nan(), "not a number");
    kani::cover!(value > -1.0 && value < 1.0, "inside");
    clips(value);
}

/// A pilot density lies between ρ_min and ρ_max for every action that is not NaN.
fn density_is_in_range(u_pilot: f32, min: f64, max: f64) {
    let density = pilot_density(u_pilot, min, max);
    assert!(density >= min && density <= max);
}

#[cfg_attr(kani, kani::proof)]
pub fn pilot_density_stays_in_range() {
    let u_pilot: f32 = kani::any();
    let min = real_between(0.0, 1.0);
    let max = real_between(min, 1.0);
    kani::assume(!u_pilot.is_nan());
    kani::cover!(u_pilot > 1.0, "asked for more than the highest");
    kani::cover!(u_pilot < -1.0, "asked for less than the lowest");
    kani::cover!(min < max, "a range");
    kani::cover!(min == max, "a fixed density");
    density_is_in_range(u_pilot, min, max);
}

/// Every action that is not NaN selects a motion, and a larger action never selects an earlier bin.
fn bins_ascend(low: f32, high: f32, map: MotionMap) {
    let bin = |u_dir: f32| motion(u_dir, map).bin(map);
    assert!(bin(low) <= bin(high));
}

#[cfg_attr(kani, kani::proof)]
pub fn motions_follow_their_bins() {
    let low: f32 = kani::any();
    let high: f32 = kani::any();
    let symmetric: bool = kani::any();
    kani::assume(low <= high);
    let map = if symmetric {
        MotionMap::Symmetric
    } else {
        MotionMap::Udlrs
    };
    let bin = |u_dir: f32| motion(u_dir, map).bin(map);
    kani::cover!(bin(low) == 0 && bin(high) == 4, "first and last bin");
    kani::cover!(bin(low) == 2, "the middle bin");
    kani::cover!(symmetric && bin(low) == 4, "down in the last bin");
    bins_ascend(low, high, map);
}

#[cfg(not(kani))]
super::standin::twins! {
    clip_is_total: 2000 cases, 4 covers;
    pilot_density_stays_in_range: 2000 cases, 4 covers;
    motions_follow_their_bins: 2000 cases, 3 covers;
}
