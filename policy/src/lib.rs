//! Policies: whatever turns the state of a mission into the next actions.
//!
//! [`network`] flies trained networks without the standard library, without allocating, with the same bits
//! on every platform. With the feature `baselines` (needs the standard library), the scripted ones of [`baselines`] come
//! along.
#![cfg_attr(not(feature = "baselines"), no_std)]
#![forbid(unsafe_code)]

#[cfg(feature = "baselines")]
pub mod baselines;
#[cfg(feature = "baselines")]
pub use baselines::*;
pub mod head;
pub mod network;
pub mod strata;
#[cfg(feature = "baselines")]
mod trained;
#[cfg(feature = "baselines")]
pub use trained::Trained;
#[cfg(any(kani, test))]
mod proofs;

use core::fmt::Display;

use jcas_core::{Model, StateRef};

/// Decides the actions of a whole fleet, step by step.
pub trait Policy: Send {
    /// What reports and traces call it.
    fn name(&self) -> &str;

    /// What reports and traces call its choice of pilot density: a pilot mode, or `learned`.
    fn pilot(&self) -> &dyn Display {
        &"learned"
    }

    /// Called before the first step of every episode. All randomness has to follow from `seed`.
    fn reset(&mut self, model: &Model<'_>, seed: u64) {
        let _ = (model, seed);
    }

    /// Whether [`Policy::see`] has to be called before each [`Policy::act`].
    fn reads_observations(&self) -> bool {
        false
    }

    /// Hands over what the UAVs observe, one row for each UAV.
    fn see(&mut self, observations: &[f32]) {
        let _ = observations;
    }

    /// Writes (u_dir, u_pilot) of each UAV into `actions`, whose length is twice the number of UAVs.
    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]);
}
