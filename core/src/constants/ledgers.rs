//! The room of the ledgers: no sum over an episode overflows its integer.

use super::energy::EnergyConstants;
use crate::config::Config;
use crate::error::{Allowed, ConfigError, Value};
use crate::words::units::milligrams;

impl Config {
    /// Checks that the worst case of every ledger over an episode fits its 64-bit integer. So no
    /// step has to check for overflow.
    pub(crate) fn ledgers_have_room(&self) -> Result<(), ConfigError> {
        const ROOM: u128 = 1 << 62;
        let plan = EnergyConstants::new(self);
        let fleet_steps = u128::from(self.uav_count) * u128::from(self.horizon_steps);
        let energy_uj = u128::from(self.uav_count) * u128::from(plan.capacity_uj)
            + fleet_steps * u128::from(plan.charge_uj.saturating_add(plan.most_asked_uj()));
        let intensity_mg_per_kwh = milligrams(self.carbon_intensity_max_kg_per_kwh);
        let carbon_ng =
            fleet_steps * u128::from(plan.charge_uj) * u128::from(intensity_mg_per_kwh) / 3_600_000;
        if energy_uj > ROOM || carbon_ng > ROOM {
            return Err(ConfigError {
                field: "horizon_steps",
                value: Value::Integer(self.horizon_steps.into()),
                allowed: Allowed::Rule(
                    "so small that the fleet's energy over an episode stays under 2^62 uJ \
                     and its carbon under 2^62 ng",
                ),
            });
        }
        Ok(())
    }
}
