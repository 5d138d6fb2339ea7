//! The rule for how long a UAV on a depot charges.

use jcas_core::{Model, StateRef};

const UJ_PER_KWH: f64 = 3.6e12;

/// Returns whether a UAV on a depot stays there to charge.
///
/// Without this rule a UAV leaves as soon as its battery reaches the return-to-base threshold. One
/// cell later the battery falls below it, and the UAV turns back. With the rule it leaves at
/// [`charge_to_leave_uj`].
#[must_use]
pub fn stays_to_charge(model: &Model<'_>, state: &StateRef<'_>, uav: usize) -> bool {
    (state.battery_uj(uav) as f64) < charge_to_leave_uj(model)
        && model.depots().contains(&state.cell(uav))
}

/// Returns the charge in µJ at which a UAV leaves a depot.
///
/// It is full, or enough above the return-to-base threshold to cross the grid (width + height - 2
/// moves). Without a threshold or a charger it is 0.
#[must_use]
pub fn charge_to_leave_uj(model: &Model<'_>) -> f64 {
    let config = model.config();
    if config.rtb_threshold_kwh <= 0.0 || config.charge_power_kw <= 0.0 {
        return 0.0;
    }
    let crossing_steps = f64::from(config.grid_width + config.grid_height - 2);
    let enough_kwh = config.rtb_threshold_kwh + crossing_steps * config.move_energy_kwh;
    enough_kwh.min(config.battery_capacity_kwh) * UJ_PER_KWH
}
