//! Grid energy and the carbon it emits, in whole microjoules, milligrams per kilowatt-hour and
//! nanograms.

use crate::model::Model;
use crate::state::StateMut;
use crate::state::scratch::StepTotals;

pub use crate::constants::carbon::{CarbonConstants, emitted_ng, scale};
pub use crate::words::units::{kilograms, milligrams};

/// A UAV's share of its fleet's carbon in nanograms, in proportion to the energy billed to it.
///
/// The carbon is rounded once, for the fleet; a share need not be a whole number.
// Proof: proofs/reward.rs, a_share_of_carbon_is_within_the_whole
#[inline(always)]
#[must_use]
pub fn share_ng(co2_ng: u64, billed_uj: u64, billed_fleet_uj: u64) -> f64 {
    // If nothing is billed to the fleet, nothing is billed to the UAV, and its share is 0.
    let fleet = if billed_fleet_uj == 0 {
        1.0
    } else {
        billed_fleet_uj as f64
    };
    let whole = co2_ng as f64;
    let share = whole * (billed_uj as f64 / fleet);
    // Rounding must not raise a share above the whole.
    if share > whole { whole } else { share }
}

/// Adds the grid energy and the carbon of a step, each rounded once, and draws the next intensity.
/// Returns the carbon in nanograms.
#[inline(always)]
pub(crate) fn emit(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    billed_uj: u64,
    totals: &mut StepTotals,
) -> u64 {
    let header = &mut state.header;
    let intensity = header.intensity_mg_per_kwh();
    let grid_uj = model.carbon().grid_uj(billed_uj);
    let co2_ng = emitted_ng(grid_uj, intensity);
    header.set_grid(header.grid_uj() + grid_uj);
    header.set_co2(header.co2_ng() + co2_ng);
    header.set_billed_intensity(intensity);
    let next = model
        .carbon()
        .intensity_mg_per_kwh(header.seed(), header.t());
    header.set_intensity(next);
    totals.co2_ng = co2_ng as f64;
    co2_ng
}
