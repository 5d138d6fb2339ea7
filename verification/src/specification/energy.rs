//! Energy in whole microjoules, carbon in whole nanograms.

use super::{Specification, World, reward::StepFacts};
use jcas_core::{ChargeBilling, Config};

const MICROJOULES_PER_KWH: f64 = 3.6e12;

/// The configuration's energies, each rounded once to microjoules.
#[derive(Clone, Debug)]
pub struct Ledger {
    /// Battery capacity B_max, in microjoules.
    pub capacity_uj: u64,
    /// Charge below which a UAV returns to base, in microjoules.
    pub return_uj: u64,
    /// Energy r_ch that a depot offers in one step, in microjoules.
    pub charge_uj: u64,
    /// Energy e_move of a step that changes the cell, in microjoules.
    pub move_uj: u64,
    /// Energy e_move of a step in the same cell, in microjoules.
    pub hover_uj: u64,
    /// Energy e_sense of a step at the highest pilot density, in microjoules.
    pub sense_uj: u64,
    /// Energy e_comm of a step at a pilot density of zero, in microjoules.
    pub comm_uj: u64,
    /// Fraction of grid energy, 1 − ρ_RE, in parts per billion.
    pub grid_share_ppb: u64,
    /// Lowest carbon intensity, in mg/kWh.
    pub intensity_min_mg_per_kwh: u64,
    /// Highest carbon intensity, in mg/kWh.
    pub intensity_max_mg_per_kwh: u64,
}

impl Ledger {
    /// Rounds every energy of the configuration half up.
    pub fn new(c: &Config) -> Self {
        let kwh = |x: f64| half_up(x * MICROJOULES_PER_KWH);
        Ledger {
            capacity_uj: kwh(c.battery_capacity_kwh),
            return_uj: kwh(c.rtb_threshold_kwh),
            // Microwatts times seconds.
            charge_uj: half_up(c.charge_power_kw * 1e9 * c.step_duration_s),
            move_uj: kwh(c.move_energy_kwh),
            hover_uj: kwh(c.hover_energy_kwh),
            sense_uj: kwh(c.sense_energy_kwh),
            comm_uj: kwh(c.comm_energy_kwh),
            grid_share_ppb: half_up((1.0 - c.renewable_share) * 1e9),
            intensity_min_mg_per_kwh: half_up(c.carbon_intensity_min_kg_per_kwh * 1e6),
            intensity_max_mg_per_kwh: half_up(c.carbon_intensity_max_kg_per_kwh * 1e6),
        }
    }
}

impl Specification {
    /// Spends, charges and bills one step. `was_sensing` is the fleet's sensing
    /// activity at the start of the sense phase. Notes what each UAV spent and was
    /// billed for in this step, and the fleet's carbon.
    pub(super) fn spend_and_charge(
        &self,
        world: &mut World,
        was_sensing: &[bool],
        facts: &mut StepFacts,
    ) {
        let e = &self.energy;
        for (i, &sensing) in was_sensing.iter().enumerate() {
            let asked = self.asked_uj(world, i, sensing);
            let spent = if asked > world.battery_uj[i] {
                world.battery_uj[i]
            } else {
                asked
            };
            world.battery_uj[i] -= spent;
            world.spent_uj[i] += spent;
            world.shortfall_uj[i] += asked - spent;
            facts.spent_uj.push(spent);
            facts.billed_uj.push(0);
            if self.is_depot(world.position[i]) {
                let room = e.capacity_uj - world.battery_uj[i];
                let accepted = if e.charge_uj > room {
                    room
                } else {
                    e.charge_uj
                };
                world.battery_uj[i] += accepted;
                world.accepted_uj[i] += accepted;
                facts.billed_uj[i] = match self.config.charge_billing {
                    ChargeBilling::Accepted => accepted,
                    ChargeBilling::Nameplate => e.charge_uj,
                };
            }
        }
        let billed = facts.billed_uj.iter().sum();
        let grid = divide_half_up(billed, e.grid_share_ppb, 1_000_000_000);
        let carbon = divide_half_up(grid, world.billed_intensity_mg_per_kwh, 3_600_000);
        world.grid_uj += grid;
        world.co2_ng += carbon;
        facts.carbon_ng = carbon;
    }

    fn asked_uj(&self, world: &World, i: usize, sensing: bool) -> u64 {
        let e = &self.energy;
        if world.grounded[i] {
            return 0;
        }
        let mut asked = if world.moved[i] {
            e.move_uj
        } else {
            e.hover_uj
        };
        if sensing {
            let per_density = e.sense_uj as f64 / self.config.pilot_density_max;
            asked += half_up(per_density * world.pilot[i]);
        }
        if world.linked[i].contains(&true) {
            asked += half_up(e.comm_uj as f64 * (1.0 - world.pilot[i]));
        }
        asked
    }
}

/// Rounds a non-negative number to the nearest integer, a half upward.
pub fn half_up(x: f64) -> u64 {
    libm::floor(x + 0.5) as u64
}

/// a · b / divisor to the nearest integer, a half upward.
fn divide_half_up(a: u64, b: u64, divisor: u128) -> u64 {
    let doubled = 2 * u128::from(a) * u128::from(b) + divisor;
    (doubled / (2 * divisor)) as u64
}
