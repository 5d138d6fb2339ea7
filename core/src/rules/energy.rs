//! Battery and its ledger, in whole microjoules, so that the balance is exact on every platform:
//! initial + accepted = stored + spent.

use crate::config::{ChargeBilling, Config};
use crate::lanes::real::floor_to_u64;
use crate::lanes::{self, Block, Cells, Lanes, at_width, ones};
use crate::model::Model;
use crate::rules::reward::StepTotals;
use crate::state::StateMut;
use crate::state::scratch::UavStepScratch;
use crate::words::bits;

/// Microjoules in a kilowatt-hour.
pub const MICROJOULES_PER_KWH: f64 = 3.6e12;

/// A non-negative real rounded half up to a whole number; the one rounding where a real enters a
/// ledger.
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

/// Settles the energy of every battery for the step.
#[inline(always)]
pub(crate) fn settle_fleet(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    per_uav: &mut UavStepScratch<'_>,
    totals: &mut StepTotals,
) -> Settled {
    let settled = at_width!(model, settle_in_blocks(model, state, per_uav));
    totals.spent_uj = settled.spent_uj;
    settled
}

/// Sums over the UAVs for a step.
#[derive(Clone, Copy, Default)]
pub(crate) struct Settled {
    pub(crate) spent_uj: u64,
    pub(crate) billed_uj: u64,
    /// Number of UAVs that changed their cell.
    pub(crate) moves: u64,
    /// Sum of the pilot densities.
    pub(crate) pilot: f64,
}

#[inline(always)]
fn settle_in_blocks<const W: usize>(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    per_uav: &mut UavStepScratch<'_>,
) -> Settled {
    let mut sums = Settled::default();
    for block in lanes::blocks::<W>(model.uav_count()) {
        settle_in(model, state, per_uav, block, &mut sums);
    }
    sums
}

#[inline(always)]
fn settle_in<const W: usize>(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    per_uav: &mut UavStepScratch<'_>,
    block: Block<W>,
    sums: &mut Settled,
) {
    let plan = model.energy();
    let density = block.load(state.pilot).map(f64::from_bits);
    let cells = block.load(state.cells);
    let (asked, moves) = asked(model, state, block, &cells, &density);
    let depots = model.depot_distances(&Cells::of(&cells));
    let there = lanes::spread::<W>(block.mask());
    let battery = block.load(state.battery);
    let (mut offered, mut billed) = ([0; W], [0; W]);
    for lane in 0..W {
        offered[lane] = ones(depots[lane] == 0) & there[lane] & plan.charge_uj;
    }
    let settled = settle_lanes(&battery, &asked, &offered, plan.capacity_uj);
    let (mut total_spent, mut total_accepted, mut total_shortfall) = (
        block.load(state.spent),
        block.load(state.accepted),
        block.load(state.shortfall),
    );
    let nameplate = ones(model.carbon().billing == ChargeBilling::Nameplate);
    for lane in 0..W {
        billed[lane] = offered[lane] & nameplate | settled.accepted_uj[lane] & !nameplate;
        total_spent[lane] += settled.spent_uj[lane];
        total_accepted[lane] += settled.accepted_uj[lane];
        total_shortfall[lane] += settled.shortfall_uj[lane];
    }
    block.store(&settled.battery_uj, state.battery);
    block.store(&total_spent, state.spent);
    block.store(&total_accepted, state.accepted);
    block.store(&total_shortfall, state.shortfall);
    block.store(&settled.spent_uj, per_uav.spent_uj);
    block.store(&billed, per_uav.billed_uj);
    // A spare lane requests no energy and receives no offer.
    sums.spent_uj += lanes::sum(&settled.spent_uj);
    sums.billed_uj += lanes::sum(&billed);
    sums.moves += moves;
    for &density in &state.pilot[block.first..][..block.count] {
        sums.pilot += f64::from_bits(density);
    }
}

/// [`Settlement`] of each lane of a block.
pub(crate) struct Settlements<const W: usize> {
    pub(crate) battery_uj: Lanes<u64, W>,
    pub(crate) spent_uj: Lanes<u64, W>,
    pub(crate) accepted_uj: Lanes<u64, W>,
    pub(crate) shortfall_uj: Lanes<u64, W>,
}

/// Settles each lane of a block by itself.
// Proof: proofs/fleet.rs, a_blocks_batteries_stay_in_their_bounds
#[inline(always)]
pub(crate) fn settle_lanes<const W: usize>(
    battery_uj: &Lanes<u64, W>,
    asked_uj: &Lanes<u64, W>,
    offered_uj: &Lanes<u64, W>,
    capacity_uj: u64,
) -> Settlements<W> {
    let (mut charge, mut spent) = ([0; W], [0; W]);
    let (mut accepted, mut shortfall) = ([0; W], [0; W]);
    for lane in 0..W {
        let one = settle(
            battery_uj[lane],
            asked_uj[lane],
            offered_uj[lane],
            capacity_uj,
        );
        charge[lane] = one.battery_uj;
        spent[lane] = one.spent_uj;
        accepted[lane] = one.accepted_uj;
        shortfall[lane] = one.shortfall_uj;
    }
    Settlements {
        battery_uj: charge,
        spent_uj: spent,
        accepted_uj: accepted,
        shortfall_uj: shortfall,
    }
}

/// Energy that each UAV of a block requests, and the number of UAVs that changed their cell.
#[inline(always)]
fn asked<const W: usize>(
    model: &Model<'_>,
    state: &StateMut<'_>,
    block: Block<W>,
    cells: &Lanes<u64, W>,
    density: &Lanes<f64, W>,
) -> (Lanes<u64, W>, u64) {
    let row = model.uav_words();
    let previous = block.load(state.previous);
    let mut any_link = [0; W];
    if row == 1 {
        any_link = block.load(state.links);
    } else {
        let links = state.links[block.first * row..].chunks_exact(row);
        for (lane, links) in block.lanes().zip(links) {
            any_link[lane] = u64::from(!bits::is_empty(links));
        }
    }
    let flies = lanes::spread::<W>(!block.bits(state.grounded) & block.mask());
    let sensing = lanes::spread::<W>(block.bits(state.sensing));
    let (mut moved, mut asked) = ([0; W], [0; W]);
    for lane in 0..W {
        moved[lane] = ones(cells[lane] != previous[lane]);
        let did = Activity {
            flies: flies[lane],
            moved: moved[lane],
            sensing: sensing[lane],
            linked: ones(any_link[lane] != 0),
        };
        asked[lane] = model.energy().asked_uj(did, density[lane]);
    }
    let moves = (lanes::gather_bits(&moved) & block.mask()).count_ones();
    (asked, u64::from(moves))
}

/// Result of a step for one battery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(kani, derive(kani::Arbitrary))]
pub struct Settlement {
    /// Charge after the step, in microjoules.
    pub battery_uj: u64,
    /// Energy spent, in microjoules.
    pub spent_uj: u64,
    /// Energy accepted from a charger, in microjoules.
    pub accepted_uj: u64,
    /// Energy requested that the battery lacked, in microjoules.
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
#[cfg_attr(kani, kani::ensures(
    |after| after.balances(battery_uj, asked_uj, offered_uj, capacity_uj)
))]
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
