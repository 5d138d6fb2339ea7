//! The energy constants of a configuration, in whole microjoules.

use crate::config::Config;
use crate::lanes::real::floor_to_u64;
use crate::words::units::{microjoules, round_half_up};

/// The energy constants of a configuration, per UAV and step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyConstants {
    /// Battery capacity (B_max), in microjoules.
    pub capacity_uj: u64,
    /// Charge in microjoules below which a UAV returns to base.
    pub rtb_uj: u64,
    /// Energy that a charger offers in a step (r_ch), in microjoules.
    pub charge_uj: u64,
    /// Energy of a step that changes the cell (e_move), in microjoules.
    pub move_uj: u64,
    /// Energy of a step in place, in microjoules.
    pub hover_uj: u64,
    /// Energy of sensing at the highest pilot density, in microjoules.
    pub sense_uj: u64,
    /// Energy of communicating with the whole waveform, in microjoules.
    pub comm_uj: u64,
    sense_uj_per_density: f64,
}

impl EnergyConstants {
    /// Rounds each constant once.
    #[must_use]
    pub fn new(config: &Config) -> Self {
        let sense_uj = microjoules(config.sense_energy_kwh);
        Self {
            capacity_uj: microjoules(config.battery_capacity_kwh),
            rtb_uj: microjoules(config.rtb_threshold_kwh),
            charge_uj: round_half_up(config.charge_power_kw * 1e9 * config.step_duration_s),
            move_uj: microjoules(config.move_energy_kwh),
            hover_uj: microjoules(config.hover_energy_kwh),
            sense_uj,
            comm_uj: microjoules(config.comm_energy_kwh),
            sense_uj_per_density: sense_uj as f64 / config.pilot_density_max,
        }
    }

    /// Upper bound of the energy that a step requests, in microjoules.
    #[must_use]
    pub fn most_asked_uj(&self) -> u64 {
        let travel = if self.move_uj > self.hover_uj {
            self.move_uj
        } else {
            self.hover_uj
        };
        travel + self.sense_uj + self.comm_uj
    }

    /// Energy in microjoules that a step requests if the UAV flies, senses and has a neighbour.
    /// This is the maximum at its pilot density.
    #[must_use]
    pub fn most_asked_at_uj(&self, moved: bool, pilot_density: f64) -> u64 {
        let did = Activity {
            flies: u64::MAX,
            moved: if moved { u64::MAX } else { 0 },
            sensing: u64::MAX,
            linked: u64::MAX,
        };
        self.asked_uj(did, pilot_density)
    }

    /// Energy that a UAV's step requests: propulsion, sensing (e_sense · ρ_pilot/ρ_max) and
    /// communication (e_comm · ρ_comm). It is computed without a branch.
    #[inline(always)]
    #[must_use]
    pub(crate) fn asked_uj(&self, did: Activity, pilot_density: f64) -> u64 {
        let travel = did.moved & self.move_uj | !did.moved & self.hover_uj;
        // Both are rounded half up. They are a few kilowatt-hours at most, far below 2^51
        // microjoules.
        let sense = floor_to_u64(self.sense_uj_per_density * pilot_density + 0.5);
        let comm = floor_to_u64(self.comm_uj as f64 * (1.0 - pilot_density) + 0.5);
        let sense = at_most(sense, self.sense_uj) & did.sensing;
        let comm = at_most(comm, self.comm_uj) & did.linked;
        (travel + sense + comm) & did.flies
    }
}

/// Activity of a UAV in a step, which decides its energy. Each field is all ones for true, 0 for
/// false.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Activity {
    /// Its battery was not empty at the start of the step.
    pub(crate) flies: u64,
    /// Its cell changed.
    pub(crate) moved: u64,
    /// Some hotspot was unknown to it or not confirmed when it sensed.
    pub(crate) sensing: u64,
    /// It has a neighbour.
    pub(crate) linked: u64,
}

const fn at_most(value: u64, bound: u64) -> u64 {
    if value > bound { bound } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_energies_are_whole_joules() {
        let plan = EnergyConstants::new(&Config::default());
        assert_eq!(plan.capacity_uj, 720_000_000_000);
        assert_eq!(plan.rtb_uj, 144_000_000_000);
        assert_eq!(plan.charge_uj, 3_000_000_000);
        assert_eq!(plan.move_uj, 2_880_000_000);
        assert_eq!(plan.sense_uj, 720_000_000);
        assert_eq!(plan.comm_uj, 180_000_000);
    }

    #[test]
    fn asks_for_what_the_activity_needs() {
        let plan = EnergyConstants::new(&Config::default());
        let (yes, no) = (u64::MAX, 0);
        let all = Activity {
            flies: yes,
            moved: yes,
            sensing: yes,
            linked: yes,
        };
        assert_eq!(
            plan.asked_uj(all, 0.30),
            2_880_000_000 + 720_000_000 + 126_000_000
        );
        assert_eq!(plan.asked_uj(Activity { flies: no, ..all }, 0.30), 0);
        let idle = Activity {
            moved: no,
            sensing: no,
            linked: no,
            ..all
        };
        assert_eq!(plan.asked_uj(idle, 0.30), 0);
    }
}
