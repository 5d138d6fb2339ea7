//! The rule for how long a UAV on a depot charges.

use jcas_core::{Model, StateRef};

const UJ_PER_KWH: f64 = 3.6e12;

/// Returns whether a UAV on a depot stays there to charge.
///
/// Without this rule a UAV leaves as soon as its battery reaches the return-to-base threshold. One
/// cell later the battery falls below it, and the UAV turns back. With the rule it leaves when
/// full, or with enough above the threshold to cross the grid (width + height - 2 moves).
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
