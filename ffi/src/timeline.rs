//! Timelines: which states follow from one another by steps alone.

use std::sync::atomic::{AtomicU64, Ordering};

/// The timeline of a simulation or of an environment of a batch. It is renewed whenever a state is
/// replaced other than by a step. A policy that remembers acts along one timeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct Timeline(u64);

static NEXT: AtomicU64 = AtomicU64::new(1);

impl Timeline {
    /// Returns a timeline that no other state has had in this process.
    pub(crate) fn renewed() -> Self {
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}
