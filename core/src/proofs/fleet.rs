//! Invariants of every fleet of a legal size.
//!
//! Let i be any UAV of a fleet of any size N from 1 to 4096.
//!
//! 1. Exactly one block of the fleet has i: `blocks_cover_each_uav_once`.
//! 2. What that block loads at i's lane is i's entry of a row, and what it stores from that lane is
//!    i's entry afterwards: `lanes::a_block_loads_and_stores_its_own_uavs`. `Block::load` and
//!    `Block::store` begin with the slice of the block's UAVs, to which Rust confines the rest. So
//!    the length of the row does not matter, and no other block writes i's entry.
//! 3. A part of a step computes all lanes by one function of the lanes alone. For batteries this is
//!    `settle_lanes`, of which `a_blocks_batteries_stay_in_their_bounds` shows that every lane
//!    stays in its bounds and balances. For pilot densities it is `densities`, of which
//!    `a_blocks_pilot_densities_stay_in_range` shows the same for the range.
//!
//! So i's battery stays in its bounds and i's pilot density in its range. The blocks are those of
//! the width that the fleet runs at, 1 or 16, and not Kani's width of two.
//!
//! Consensus works on whole rows and not in blocks: `knowledge::what_is_received_is_added`.

use super::energy::ROOM_UJ;
use super::inputs::{between, real_between};
#[cfg(not(kani))]
use super::standin as kani;
use crate::lanes::{Block, Lanes};
use crate::rules::action::densities;
use crate::rules::energy::settle_lanes;

/// The largest legal fleet.
const UAVS_MAX: u64 = 4096;
/// The width of fleets that fill half a block.
const WIDE: usize = 16;

/// The block with this number is the only one that has a UAV.
fn covers_once<const W: usize>(uavs: usize) {
    let uav = between(0, uavs as u64 - 1) as usize;
    let number = between(0, (uavs as u64 - 1) / W as u64) as usize;
    let block = Block::<W>::of(number * W, uavs);
    assert!(block.count >= 1 && block.count <= W && block.first + block.count <= uavs);
    let has = uav >= block.first && uav < block.first + block.count;
    assert!(has == (number == uav / W));
}

#[cfg_attr(kani, kani::proof)]
pub fn blocks_cover_each_uav_once() {
    let uavs = between(1, UAVS_MAX) as usize;
    kani::cover!(uavs == UAVS_MAX as usize, "the largest fleet");
    kani::cover!(uavs % WIDE == 1, "a block of one UAV");
    covers_once::<WIDE>(uavs);
    covers_once::<1>(uavs);
}

/// Every lane's battery stays in its bounds, and its ledger balances.
fn settles_every_lane<const W: usize>(
    battery: &Lanes<u64, W>,
    asked: &Lanes<u64, W>,
    offered: &Lanes<u64, W>,
    capacity: u64,
) -> u64 {
    let after = settle_lanes(battery, asked, offered, capacity);
    for lane in 0..W {
        assert!(after.battery_uj[lane] <= capacity);
        let had = battery[lane] + after.accepted_uj[lane];
        assert!(had == after.battery_uj[lane] + after.spent_uj[lane]);
        assert!(after.spent_uj[lane] + after.shortfall_uj[lane] == asked[lane]);
    }
    after.battery_uj[W - 1]
}

fn any_quantities<const W: usize>(most: u64) -> Lanes<u64, W> {
    let mut lanes = [0; W];
    for lane in &mut lanes {
        *lane = between(0, most);
    }
    lanes
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(17))]
#[cfg_attr(kani, kani::stub_verified(crate::rules::energy::settle))]
pub fn a_blocks_batteries_stay_in_their_bounds() {
    let capacity = between(1, ROOM_UJ);
    let battery = any_quantities::<WIDE>(capacity);
    let (asked, offered) = (any_quantities(ROOM_UJ), any_quantities(ROOM_UJ));
    let last = settles_every_lane(&battery, &asked, &offered, capacity);
    kani::cover!(
        last == 0 && battery[WIDE - 1] > 0,
        "the last lane runs empty"
    );
    kani::cover!(last == capacity, "the last lane charges to full");
    settles_every_lane::<1>(&[battery[0]], &[asked[0]], &[offered[0]], capacity);
}

/// Every lane's pilot density is in the configured range, for any number as action.
fn densities_stay_in_range<const W: usize>(actions: &Lanes<f32, W>, min: f64, max: f64) {
    let pilot = densities(actions, min, max);
    for lane in 0..W {
        let density = f64::from_bits(pilot[lane]);
        assert!(density >= min && density <= max);
    }
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(17))]
#[cfg_attr(
    kani,
    kani::stub(
        crate::rules::action::pilot_density,
        crate::proofs::stubs::any_pilot_density
    )
)]
pub fn a_blocks_pilot_densities_stay_in_range() {
    let min = real_between(0.0, 1.0);
    let max = real_between(min, 1.0);
    let mut actions: Lanes<f32, WIDE> = kani::any();
    for action in &mut actions {
        // A step refuses a NaN before.
        *action = if action.is_nan() { 0.0 } else { *action };
    }
    kani::cover!(min < max, "a range");
    kani::cover!(actions[WIDE - 1] > 1.0, "an action to clip");
    densities_stay_in_range(&actions, min, max);
    densities_stay_in_range(&[actions[0]], min, max);
}

#[cfg(not(kani))]
super::standin::twins! {
    blocks_cover_each_uav_once: 4000 cases, 2 covers;
    a_blocks_batteries_stay_in_their_bounds: 4000 cases, 2 covers;
    a_blocks_pilot_densities_stay_in_range: 4000 cases, 2 covers;
}

/// Catches a larger legal fleet than what is shown is for.
#[test]
fn the_largest_fleet_is_the_largest_legal_one() {
    let field = crate::config::Config::FIELDS
        .iter()
        .find(|field| field.name == "uav_count");
    assert_eq!(field.unwrap().high, UAVS_MAX as f64);
}
