//! The steering of baselines, and the UAVs that they can steer.

use jcas_core::{Model, Motion, StateRef};

use super::memory::OutOfMemory;

/// A steering rule: it moves the fleet while hotspots are unconfirmed.
pub trait Steering: Send {
    /// Called before the first step of an episode.
    ///
    /// # Errors
    /// [`OutOfMemory`] if memory runs out. The call must then succeed once before the next call of
    /// [`Steering::steer`].
    fn reset(&mut self, model: &Model<'_>, seed: u64) -> Result<(), OutOfMemory> {
        let _ = (model, seed);
        Ok(())
    }

    /// Writes the motion of each UAV. Motions of UAVs that are grounded or return to base have no
    /// effect.
    ///
    /// # Errors
    /// [`OutOfMemory`] if memory runs out. A later call in the same state gives the same motions as
    /// without the failure.
    fn steer(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory>;
}

/// Returns whether a UAV follows its action: it is neither grounded nor returning to base.
pub(super) fn can_fly(state: &StateRef<'_>, uav: usize) -> bool {
    !state.grounded(uav) && !state.returning(uav)
}
