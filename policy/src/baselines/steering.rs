//! How a baseline moves, and who can.

use jcas_core::{Model, Motion, StateRef};

/// How a baseline moves while hotspots are unconfirmed.
pub trait Steering: Send {
    /// Before the first step of an episode.
    fn reset(&mut self, model: &Model<'_>, seed: u64) {
        let _ = (model, seed);
    }

    /// Writes each UAV's motion. Motions of UAVs that are grounded or return to base have no effect.
    fn steer(&mut self, model: &Model<'_>, state: &StateRef<'_>, motions: &mut [Motion]);
}

/// Whether a UAV goes where it is told: neither grounded, nor on its way to a depot, nor charging.
pub(super) fn can_fly(state: &StateRef<'_>, uav: usize) -> bool {
    !state.grounded(uav) && !state.returning(uav)
}
