//! Loops over UAVs in blocks of lanes, with the width of a block as a constant parameter.
//!
//! The compiler turns a loop over arrays of a fixed width into vector instructions of the target's
//! width. Every lane computes its formula in the same order, so that the bits are the same at any
//! width. A fleet that fills half a wide block is computed [`WIDE`] UAVs at a time. A smaller fleet
//! runs the same source at a width of one, where an array compiles to a scalar. [`at_width`]
//! chooses the width at the entry of each part of a step.
//!
//! Values at an index that differs between lanes are gathered into an array first. A bounds check
//! in the main loop would keep the compiler from vectorising it.
//!
//! The picture shows a block of eleven UAVs at a width of sixteen. Each half of the lanes is one
//! contiguous load from a row:
//!
//! ```text
//! row       0  1  2  3  4  5  6  7  8  9 10
//!
//! lane      0  1  2  3  4  5  6  7 | 8  9 10 11 12 13 14 15
//! UAV       0  1  2  3  4  5  6  7 | 3  4  5  6  7  8  9 10
//!           '--- first eight ----'   '-- last eight, of which the first five are spare copies
//! mask      1  1  1  1  1  1  1  1 | 0  0  0  0  0  1  1  1
//! ```

mod block;
mod cells;
mod gather;
pub(crate) mod real;

pub(crate) use block::{Block, blocks, blocks_of};
pub(crate) use cells::{Cells, Rows};
pub(crate) use gather::gather;

/// Number of UAVs in a wide block. Kani checks the same source at a width of two: two UAVs fill a
/// block, and three take a second block that is not full.
pub(crate) const WIDE: usize = if cfg!(kani) { 2 } else { 16 };

/// Smallest fleet that is computed in wide blocks; for fewer UAVs a width of one costs less. Under
/// Kani every fleet is computed in wide blocks, so that its two UAVs do not run at a width of one.
pub(crate) const WIDE_FLEET: usize = if cfg!(kani) { 1 } else { 8 };

/// The width of the blocks of a fleet.
#[cfg(not(test))]
#[inline(always)]
pub(crate) const fn width_of(uavs: usize) -> usize {
    if uavs < WIDE_FLEET { 1 } else { WIDE }
}

/// Calls a part of a step at the fleet's width.
macro_rules! at_width {
    ($model:expr, $part:ident($($argument:expr),* $(,)?)) => {
        match $crate::lanes::width_of($model.uav_count()) {
            1 => $part::<1>($($argument),*),
            // Tests also run at the width of Kani's proofs.
            #[cfg(test)]
            2 => $part::<2>($($argument),*),
            _ => $part::<{ $crate::lanes::WIDE }>($($argument),*),
        }
    };
}
pub(crate) use at_width;

/// A value for each lane of a block.
pub(crate) type Lanes<T, const W: usize> = [T; W];

/// A value aligned to a cache line. A vector across two lines is slower to load, and one across two
/// pages much slower.
#[repr(align(64))]
#[derive(Clone, Copy)]
pub(crate) struct CacheAligned<T>(pub(crate) T);

/// All ones for true, 0 for false.
#[inline(always)]
pub(crate) fn ones(yes: bool) -> u64 {
    0u64.wrapping_sub(u64::from(yes))
}

/// For each lane, all ones if its bit is set, else 0.
#[inline(always)]
pub(crate) fn spread<const W: usize>(bits: u64) -> Lanes<u64, W> {
    let mut lanes = [0; W];
    for lane in 0..W {
        let bit = 1 << lane;
        lanes[lane] = if bits & bit == bit { u64::MAX } else { 0 };
    }
    force_vector(&mut lanes);
    lanes
}

/// The sum over the lanes.
#[inline(always)]
pub(crate) fn sum<const W: usize>(lanes: &Lanes<u64, W>) -> u64 {
    let mut sum = 0;
    for lane in 0..W {
        sum += lanes[lane];
    }
    sum
}

/// The set of lanes that are all ones; the other lanes must be 0.
#[inline(always)]
pub(crate) fn gather_bits<const W: usize>(lanes: &Lanes<u64, W>) -> u64 {
    let mut set = [0; W];
    for lane in 0..W {
        set[lane] = lanes[lane] & 1 << lane;
    }
    force_vector(&mut set);
    let mut bits = 0;
    for lane in 0..W {
        bits |= set[lane];
    }
    bits
}

/// Stops LLVM from scalarising an array of lanes, which it does when lanes are later used
/// individually. It affects speed alone, and does nothing at a width of one.
#[inline(always)]
pub(crate) fn force_vector<T, const W: usize>(lanes: &mut [T; W]) {
    if W > 1 {
        core::hint::black_box(lanes);
    }
}

/// The width of the blocks of a fleet, or the width that a test set.
#[cfg(test)]
pub(crate) fn width_of(uavs: usize) -> usize {
    forced::width().unwrap_or(if uavs < WIDE_FLEET { 1 } else { WIDE })
}

/// A width that tests set in place of the fleet's own.
#[cfg(test)]
pub(crate) mod forced {
    use core::cell::Cell;

    std::thread_local! {
        static WIDTH: Cell<Option<usize>> = const { Cell::new(None) };
    }

    /// Runs a closure at a width of 1, 2 or [`super::WIDE`].
    pub(crate) fn at<T>(width: usize, fly: impl FnOnce() -> T) -> T {
        let before = WIDTH.replace(Some(width));
        let result = fly();
        WIDTH.set(before);
        result
    }

    /// Sets the width for the rest of this thread.
    pub(crate) fn set(width: usize) {
        WIDTH.set(Some(width));
    }

    pub(super) fn width() -> Option<usize> {
        WIDTH.get()
    }
}
