//! P4: carbon never falls and never overflows.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::config::Config;
use crate::constants::carbon::{CarbonConstants, emitted_ng};

/// Largest legal carbon intensity: 10 kg/kWh.
const INTENSITY_MAX_MG_PER_KWH: u64 = 10_000_000;

/// A legal configuration's ledgers stay below this over an episode (`Config::validate`).
const ROOM: u64 = 1 << 62;

/// Adding a step's carbon neither lowers nor overflows the sum.
fn adds_up(co2_ng: u64, grid_uj: u64, intensity_mg_per_kwh: u64) -> u64 {
    let emitted = emitted_ng(grid_uj, intensity_mg_per_kwh);
    assert!(co2_ng + emitted >= co2_ng);
    emitted
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn carbon_never_falls() {
    let co2_ng = between(0, ROOM);
    let grid_uj = between(0, 1 << 40);
    let intensity = between(0, INTENSITY_MAX_MG_PER_KWH);
    let emitted = adds_up(co2_ng, grid_uj, intensity);
    kani::cover!(emitted > 0, "something is emitted");
    kani::cover!(grid_uj > 0 && emitted == 0, "rounded to nothing");
}

/// What charges the whole fleet of the smallest model in a step.
pub(super) const FLEET_UJ: u64 = 6_000_000_000;
/// Highest intensity of the default configuration.
pub(super) const INTENSITY_MG_PER_KWH: u64 = 400_000;
/// What charging that fleet at that intensity emits.
pub(super) const FLEET_NG: u64 = 666_666_667;

/// A step of the smallest model emits no more than its whole fleet charging at the highest
/// intensity.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn emission_is_bounded() {
    let grid_uj = between(0, FLEET_UJ);
    let intensity = between(0, INTENSITY_MG_PER_KWH);
    let emitted = emitted_ng(grid_uj, intensity);
    kani::cover!(emitted == FLEET_NG, "the most");
    assert!(emitted <= FLEET_NG);
}

/// The grid's share is at most the whole.
fn is_a_share(plan: &CarbonConstants, billed_uj: u64) {
    assert!(plan.grid_uj(billed_uj) <= billed_uj);
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn grid_energy_is_a_share_of_what_is_billed() {
    let plan = CarbonConstants::new(&Config::default());
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
    emission_is_bounded: 4000 cases, 1 covers;
    grid_energy_is_a_share_of_what_is_billed: 2000 cases, 2 covers;
}

#[cfg(test)]
mod wide {
    use super::*;
    use crate::constants::energy::EnergyConstants;
    use crate::model::any_model::smallest;
    use proptest::prelude::*;

    proptest! {
        /// Inputs go beyond the harness's bound, up to the most that a legal configuration can
        /// bill. The equation is tested too, because no solver has managed its division: a step's
        /// carbon is the exact product to within half a unit.
        #[test]
        fn carbon_follows_its_equation(
            co2 in 0..ROOM, grid in 0..(1u64 << 62), intensity in 0..=INTENSITY_MAX_MG_PER_KWH,
        ) {
            let exact = u128::from(grid) * u128::from(intensity);
            // 2^62 ng is the ledger's room, so a legal grid energy emits at most that.
            prop_assume!(exact / 3_600_000 < u128::from(ROOM));
            let rounded = u128::from(adds_up(co2, grid, intensity)) * 3_600_000;
            prop_assert!(rounded <= exact + 1_800_000 && exact < rounded + 1_800_000);
        }
    }

    /// Catches a change of the smallest model that the stub of a step's emission does not follow.
    #[test]
    fn the_smallest_fleet_is_the_one_that_kani_is_given() {
        let (energy, carbon) = (
            EnergyConstants::new(&smallest()),
            CarbonConstants::new(&smallest()),
        );
        assert_eq!(u64::from(smallest().uav_count) * energy.charge_uj, FLEET_UJ);
        assert_eq!(carbon.intensity_max_mg_per_kwh, INTENSITY_MG_PER_KWH);
        assert_eq!(emitted_ng(FLEET_UJ, INTENSITY_MG_PER_KWH), FLEET_NG);
    }
}
