//! Battery and its ledger, in whole microjoules, so that the balance is exact on every platform:
//! initial + accepted = stored + spent.

use crate::config::ChargeBilling;
use crate::constants::energy::Activity;
use crate::lanes::{self, Block, Cells, Lanes, at_width, ones};
use crate::model::Model;
use crate::state::StateMut;

pub use crate::constants::energy::EnergyConstants;
use crate::state::scratch::{StepTotals, UavStepScratch};
use crate::words::bits;
pub use crate::words::units::{MICROJOULES_PER_KWH, kwh, microjoules, round_half_up};

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
