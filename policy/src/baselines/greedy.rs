//! `greedy`: each UAV flies to the unconfirmed hotspot nearest to itself and stays there.

use jcas_core::motion::toward;
use jcas_core::{Model, Motion, StateRef};

use super::memory::OutOfMemory;
use super::steering::Steering;

/// The policy `greedy`, in which every UAV steers for itself. As the fleet starts in one cell, most
/// UAVs still fly together. Ties go to the hotspot with the lower index.
#[derive(Clone, Debug, Default)]
pub struct Greedy;

impl Steering for Greedy {
    fn steer(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory> {
        for (uav, motion) in motions.iter_mut().enumerate() {
            let here = state.cell(uav);
            let target = (0..model.hotspot_count())
                .filter(|&hotspot| !state.confirmed(hotspot))
                .map(|hotspot| state.hotspot_cell(hotspot))
                .min_by_key(|&cell| here.manhattan(cell));
            *motion = target.map_or(Motion::Stay, |cell| toward(here, cell));
        }
        Ok(())
    }
}
