//! When a UAV that stands on a depot should go on charging.

use jcas_core::{Model, StateRef};

const UJ_PER_KWH: f64 = 3.6e12;

/// Whether a UAV on a depot stays there until its charge is worth a flight.
///
/// Without it a UAV leaves as soon as its battery reaches the return-to-base threshold, falls below it
/// one cell later, and turns back. It leaves with enough above the threshold for a flight across the
/// grid (width + height - 2 moves), or full.
#[must_use]
pub fn stays_to_charge(model: &Model<'_>, state: &StateRef<'_>, uav: usize) -> bool {
    let config = model.config();
    if config.rtb_threshold_kwh <= 0.0 || config.charge_power_kw <= 0.0 {
        return false;
    }
    let crossing_steps = f64::from(config.grid_width + config.grid_height - 2);
    let enough_kwh = config.rtb_threshold_kwh + crossing_steps * config.move_energy_kwh;
    let wanted_kwh = enough_kwh.min(config.battery_capacity_kwh);
    let here = state.cell(uav);
    (state.battery_uj(uav) as f64) < wanted_kwh * UJ_PER_KWH && model.depots().contains(&here)
}
