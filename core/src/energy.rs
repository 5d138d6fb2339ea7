//! Battery and its ledger, in whole microjoules, so that the balance is exact on every platform:
//! initial + accepted = stored + spent.

use crate::config::Config;
use crate::lanes::real::whole;
use crate::lanes::{Lanes, WIDTH};

/// Microjoules in a kilowatt-hour.
pub const MICROJOULES_PER_KWH: f64 = 3.6e12;

/// A non-negative real rounded half up to a whole number; the one rounding where a real enters a ledger.
#[inline]
#[must_use]
pub fn round_half_up(value: f64) -> u64 {
    (value + 0.5) as u64
}

/// Kilowatt-hours as whole microjoules.
#[must_use]
pub fn microjoules(kwh: f64) -> u64 {
    round_half_up(kwh * MICROJOULES_PER_KWH)
}

/// Whole microjoules as kilowatt-hours, for reports, rewards and observations.
#[inline]
#[must_use]
pub fn kwh(microjoules: u64) -> f64 {
    microjoules as f64 / MICROJOULES_PER_KWH
}

/// The energy constants of a configuration, per UAV and step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyPlan {
    /// Battery capacity (B_max).
    pub capacity_uj: u64,
    /// Charge below which a UAV returns to base.
    pub rtb_uj: u64,
    /// What a charger offers in a step (r_ch).
    pub charge_uj: u64,
    /// A step that changes the cell (e_move).
    pub move_uj: u64,
    /// A step in place.
    pub hover_uj: u64,
    /// Sensing at the highest pilot density.
    pub sense_uj: u64,
    /// Communicating with the whole waveform.
    pub comm_uj: u64,
    sense_uj_per_density: f64,
}

impl EnergyPlan {
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

    /// No step asks for more than this.
    #[must_use]
    pub fn most_asked_uj(&self) -> u64 {
        let travel = if self.move_uj > self.hover_uj {
            self.move_uj
        } else {
            self.hover_uj
        };
        travel + self.sense_uj + self.comm_uj
    }

    /// What a UAV's step asks for: propulsion, sensing (e_sense · ρ_pilot/ρ_max) and communication
    /// (e_comm · ρ_comm).
    #[inline]
    #[must_use]
    pub fn asked_uj(&self, activity: Activity, pilot_density: f64) -> u64 {
        if activity.grounded {
            return 0;
        }
        let travel = if activity.moved {
            self.move_uj
        } else {
            self.hover_uj
        };
        let sense = if activity.sensing {
            at_most(
                round_half_up(self.sense_uj_per_density * pilot_density),
                self.sense_uj,
            )
        } else {
            0
        };
        let comm = if activity.linked {
            at_most(
                round_half_up(self.comm_uj as f64 * (1.0 - pilot_density)),
                self.comm_uj,
            )
        } else {
            0
        };
        travel + sense + comm
    }
}

/// What the UAVs of a block did in a step: all ones for yes.
pub(crate) struct Activities {
    pub(crate) flies: Lanes<u64>,
    pub(crate) moved: Lanes<u64>,
    pub(crate) sensing: Lanes<u64>,
    pub(crate) linked: Lanes<u64>,
}

impl EnergyPlan {
    /// [`Self::asked_uj`] of each UAV of a block.
    #[inline(always)]
    pub(crate) fn asked_in_lanes(&self, did: &Activities, density: &Lanes<f64>) -> Lanes<u64> {
        let mut asked = [0; WIDTH];
        for lane in 0..WIDTH {
            let travel = did.moved[lane] & self.move_uj | !did.moved[lane] & self.hover_uj;
            // At most some kilowatt-hours: far below 2^51.
            let sense = whole(self.sense_uj_per_density * density[lane] + 0.5);
            let comm = whole(self.comm_uj as f64 * (1.0 - density[lane]) + 0.5);
            let sense = at_most(sense, self.sense_uj) & did.sensing[lane];
            let comm = at_most(comm, self.comm_uj) & did.linked[lane];
            asked[lane] = (travel + sense + comm) & did.flies[lane];
        }
        asked
    }
}

/// What a UAV did in a step, as far as its battery is concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Activity {
    /// Its battery was empty at the start of the step.
    pub grounded: bool,
    /// Its cell changed.
    pub moved: bool,
    /// It did not know some hotspot when it sensed.
    pub sensing: bool,
    /// It has a neighbour.
    pub linked: bool,
}

/// What a step did to a battery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(kani, derive(kani::Arbitrary))]
pub struct Settlement {
    /// Charge after the step.
    pub battery_uj: u64,
    /// Energy spent.
    pub spent_uj: u64,
    /// Energy accepted from a charger.
    pub accepted_uj: u64,
    /// Energy asked for that was not there.
    pub shortfall_uj: u64,
}

impl Settlement {
    /// Whether this settles a battery: within its bounds, and to the last microjoule.
    #[cfg(any(kani, test))]
    pub(crate) fn balances(&self, battery: u64, asked: u64, offered: u64, capacity: u64) -> bool {
        self.battery_uj <= capacity
            && self.spent_uj <= battery
            && self.accepted_uj <= offered
            && self.accepted_uj <= capacity
            && battery + self.accepted_uj == self.battery_uj + self.spent_uj
            && self.spent_uj <= asked
            && self.shortfall_uj == asked - self.spent_uj
            && (self.shortfall_uj == 0 || self.spent_uj == battery)
    }
}

/// Spends first, then charges: b(t+1) = min(B_max, b(t) - e(t) + χ r_ch), never below 0.
#[cfg_attr(kani, kani::requires(battery_uj <= capacity_uj && capacity_uj <= 1 << 62))]
#[cfg_attr(kani, kani::ensures(|after| after.balances(battery_uj, asked_uj, offered_uj, capacity_uj)))]
#[inline(always)]
#[must_use]
pub fn settle(battery_uj: u64, asked_uj: u64, offered_uj: u64, capacity_uj: u64) -> Settlement {
    let spent_uj = at_most(asked_uj, battery_uj);
    let left_uj = battery_uj - spent_uj;
    let accepted_uj = at_most(offered_uj, capacity_uj.saturating_sub(left_uj));
    Settlement {
        battery_uj: left_uj + accepted_uj,
        spent_uj,
        accepted_uj,
        shortfall_uj: asked_uj - spent_uj,
    }
}

#[inline(always)]
const fn at_most(value: u64, bound: u64) -> u64 {
    if value > bound { bound } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_energies_are_whole_joules() {
        let plan = EnergyPlan::new(&Config::default());
        assert_eq!(plan.capacity_uj, 720_000_000_000);
        assert_eq!(plan.rtb_uj, 144_000_000_000);
        assert_eq!(plan.charge_uj, 3_000_000_000);
        assert_eq!(plan.move_uj, 2_880_000_000);
        assert_eq!(plan.sense_uj, 720_000_000);
        assert_eq!(plan.comm_uj, 180_000_000);
    }

    #[test]
    fn asks_for_what_the_activity_needs() {
        let plan = EnergyPlan::new(&Config::default());
        let all = Activity {
            grounded: false,
            moved: true,
            sensing: true,
            linked: true,
        };
        assert_eq!(
            plan.asked_uj(all, 0.30),
            2_880_000_000 + 720_000_000 + 126_000_000
        );
        assert_eq!(
            plan.asked_uj(
                Activity {
                    grounded: true,
                    ..all
                },
                0.30
            ),
            0
        );
        let idle = Activity {
            moved: false,
            sensing: false,
            linked: false,
            ..all
        };
        assert_eq!(plan.asked_uj(idle, 0.30), 0);
    }

    #[test]
    fn spends_what_is_there_and_counts_the_rest() {
        assert_eq!(
            settle(5, 8, 0, 10),
            Settlement {
                battery_uj: 0,
                spent_uj: 5,
                accepted_uj: 0,
                shortfall_uj: 3
            }
        );
        assert_eq!(
            settle(9, 2, 100, 10),
            Settlement {
                battery_uj: 10,
                spent_uj: 2,
                accepted_uj: 3,
                shortfall_uj: 0
            }
        );
    }
}
