//! How a baseline moves, and who can.

use jcas_core::{Model, Motion, StateRef};

use super::memory::OutOfMemory;

/// How a baseline moves while hotspots are unconfirmed.
pub trait Steering: Send {
    /// Before the first step of an episode.
    ///
    /// # Errors
    /// [`OutOfMemory`]: it has to be called again before anything is steered.
    fn reset(&mut self, model: &Model<'_>, seed: u64) -> Result<(), OutOfMemory> {
        let _ = (model, seed);
        Ok(())
    }

    /// Writes each UAV's motion. Motions of UAVs that are grounded or return to base have no effect.
    ///
    /// # Errors
    /// [`OutOfMemory`]: called again in the same state it steers as if it had not failed.
    fn steer(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory>;
}

/// Whether a UAV goes where it is told: neither grounded, nor on its way to a depot, nor charging.
pub(super) fn can_fly(state: &StateRef<'_>, uav: usize) -> bool {
    !state.grounded(uav) && !state.returning(uav)
}
