//! The steering of baselines, and the UAVs that they can steer.

use jcas_core::{Cell, Model, Motion, StateRef};

use super::memory::OutOfMemory;
use crate::{MemoryError, MemoryReader};

/// A steering rule: it moves the fleet while hotspots are unconfirmed.
pub trait Steering: Send {
    /// Called before the first step of an episode.
    ///
    /// # Errors
    /// [`OutOfMemory`] if memory runs out. The call must then succeed once before the next call of
    /// [`Steering::steer`].
    fn reset(&mut self, model: &Model<'_>) -> Result<(), OutOfMemory> {
        let _ = model;
        Ok(())
    }

    /// Writes what the rule remembers.
    fn save(&self, write: &mut dyn FnMut(u64)) {
        let _ = write;
    }

    /// Reads what [`Steering::save`] wrote, after a reset.
    ///
    /// # Errors
    /// [`MemoryError`] if the words are no memory of the rule. The rule must be reset then.
    fn load(&mut self, model: &Model<'_>, read: &mut MemoryReader<'_>) -> Result<(), MemoryError> {
        let _ = (model, read);
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

/// Returns the cell with this row-major index.
pub(super) fn cell_of(model: &Model<'_>, index: usize) -> Cell {
    let width = model.config().grid_width as usize;
    Cell {
        x: (index % width) as u32,
        y: (index / width) as u32,
    }
}

/// Returns whether a quorum has confirmed a hotspot in the cell, truly or falsely. Every UAV
/// observes that.
pub(super) fn settled(state: &StateRef<'_>, index: usize, cell: Cell) -> bool {
    let mut hotspots = 0..state.hotspot_count();
    state.falsely_confirmed(index)
        || hotspots.any(|j| state.confirmed(j) && state.hotspot_cell(j) == cell)
}
