//! Policies: programs that choose the next actions of a fleet from the state of its episode.
//!
//! [`network`] runs trained networks without the standard library and without allocation. It gives
//! the same bits on every platform. The feature `baselines`, which needs the standard library, adds
//! the scripted policies of [`baselines`].
#![cfg_attr(not(feature = "baselines"), no_std)]
#![forbid(unsafe_code)]

#[cfg(feature = "baselines")]
pub mod baselines;
#[cfg(feature = "baselines")]
pub use baselines::*;
mod charge;
pub use charge::{charge_to_leave_uj, stays_to_charge};
pub mod geometry;
pub mod head;
pub mod memory;
pub use memory::{MemoryError, MemoryReader};
mod names;
pub use names::{BaselineKind, NamedPolicy, PLAN, PolicyNames, REPLAN, named_policies};
pub mod network;
#[cfg(feature = "baselines")]
mod trained;
#[cfg(feature = "baselines")]
pub use trained::Trained;
#[cfg(any(kani, test))]
mod proofs;

use core::fmt::Display;

use jcas_core::{Config, Model, StateRef, action};

/// The action component u_pilot, in [-1, 1], that asks for a density.
#[must_use]
pub fn action_of(config: &Config, density: f64) -> f32 {
    action::pilot_action(density, config.pilot_density_min, config.pilot_density_max)
}

/// A policy: it chooses the actions of a whole fleet, step by step.
pub trait Policy: Send {
    /// The name of the policy in reports and traces.
    fn name(&self) -> &str;

    /// The name of the choice of pilot density in reports and traces: a pilot mode, `learned`, or
    /// `constant` where a trained policy does not choose.
    fn pilot(&self) -> &dyn Display {
        &"learned"
    }

    /// Forgets everything, as before the first step of an episode. All randomness must follow from
    /// `seed`.
    fn reset(&mut self, model: &Model<'_>, seed: u64) {
        let _ = (model, seed);
    }

    /// Returns whether the actions in a state depend on what the policy did before. If they do, it
    /// acts in the states of one episode, one after the other.
    fn remembers(&self) -> bool {
        false
    }

    /// Writes what the policy remembers, as words that [`Policy::load_memory`] reads.
    fn save_memory(&self, write: &mut dyn FnMut(u64)) {
        let _ = write;
    }

    /// Replaces what the policy remembers by the words that [`Policy::save_memory`] of an equal
    /// policy wrote, all of them.
    ///
    /// # Errors
    /// [`MemoryError`] if the words are no memory of this policy and model, or if the system has no
    /// memory for it. The policy does not change then.
    fn load_memory(
        &mut self,
        model: &Model<'_>,
        read: &mut MemoryReader<'_>,
    ) -> Result<(), MemoryError> {
        let _ = model;
        read.end()
    }

    /// Returns whether [`Policy::see`] has to be called before each [`Policy::act`].
    fn reads_observations(&self) -> bool {
        false
    }

    /// Passes what the UAVs observe: one row of `Model::observation_len` numbers for each UAV.
    fn see(&mut self, observations: &[f32]) {
        let _ = observations;
    }

    /// Writes (u_dir, u_pilot) of each UAV into `actions`. Its length is twice the number of UAVs,
    /// and each component lies in [-1, 1].
    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]);
}
