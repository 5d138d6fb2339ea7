//! P4: carbon never falls and never overflows.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::carbon::{CarbonPlan, emitted_ng};
use crate::config::Config;

/// Largest legal carbon intensity: 10 kg/kWh.
const INTENSITY_MAX_MG_PER_KWH: u64 = 10_000_000;

/// A legal configuration's ledgers stay below this over an episode (`Config::validate`).
const ROOM: u64 = 1 << 62;

/// Adding a step's carbon neither lowers nor overflows the sum, and is what the equation says to
/// within half a unit.
fn adds_up(co2_ng: u64, grid_uj: u64, intensity_mg_per_kwh: u64) {
    let emitted = emitted_ng(grid_uj, intensity_mg_per_kwh);
    let exact = u128::from(grid_uj) * u128::from(intensity_mg_per_kwh);
    let rounded = u128::from(emitted) * 3_600_000;
    assert!(rounded <= exact + 1_800_000 && exact < rounded + 1_800_000);
    assert!(co2_ng + emitted >= co2_ng);
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn carbon_never_falls() {
    let co2_ng = between(0, ROOM);
    let grid_uj = between(0, 1 << 40);
    let intensity = between(0, INTENSITY_MAX_MG_PER_KWH);
    kani::cover!(emitted_ng(grid_uj, intensity) > 0, "something is emitted");
    kani::cover!(
        grid_uj > 0 && emitted_ng(grid_uj, intensity) == 0,
        "rounded to nothing"
    );
    adds_up(co2_ng, grid_uj, intensity);
}

/// The grid's share is at most the whole.
fn is_a_share(plan: &CarbonPlan, billed_uj: u64) {
    assert!(plan.grid_uj(billed_uj) <= billed_uj);
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn grid_energy_is_a_share_of_what_is_billed() {
    let plan = CarbonPlan::new(&Config::default());
    let billed_uj = between(0, 1 << 50);
    kani::cover!(
        plan.grid_uj(billed_uj) < billed_uj,
        "some of it is renewable"
    );
    kani::cover!(plan.grid_uj(billed_uj) == billed_uj, "too little to divide");
    is_a_share(&plan, billed_uj);
}

#[cfg(not(kani))]
super::standin::twins! {
    carbon_never_falls: 4000 cases, 2 covers;
    grid_energy_is_a_share_of_what_is_billed: 2000 cases, 2 covers;
}

#[cfg(test)]
mod wide {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The same beyond the harness's bound: all that a legal configuration can bill.
        #[test]
        fn carbon_never_falls(
            co2 in 0..ROOM, grid in 0..(1u64 << 62), intensity in 0..=INTENSITY_MAX_MG_PER_KWH,
        ) {
            // 2^62 ng is the ledger's room, so a legal grid energy emits at most that.
            prop_assume!(u128::from(grid) * u128::from(intensity) / 3_600_000 < u128::from(ROOM));
            adds_up(co2, grid, intensity);
        }
    }
}
