//! P3: a battery stays in [0, B_max], and its ledger balances to the last microjoule.

use super::inputs::{between, real_between};
#[cfg(not(kani))]
use super::standin as kani;
use crate::config::Config;
use crate::constants::energy::{Activity, EnergyConstants};
use crate::lanes::ones;
use crate::rules::energy::settle;

/// A legal configuration's ledgers stay below this (`Config::validate`).
pub(super) const ROOM_UJ: u64 = 1 << 62;

/// What was there and what came in is what is there and what went out, and the battery is in its
/// bounds.
fn balances(battery: u64, asked: u64, offered: u64, capacity: u64) {
    let after = settle(battery, asked, offered, capacity);
    assert!(after.balances(battery, asked, offered, capacity));
}

#[cfg_attr(kani, kani::proof)]
pub fn battery_ledger_balances() {
    let capacity = between(1, ROOM_UJ);
    let battery = between(0, capacity);
    let asked = between(0, ROOM_UJ);
    let offered = between(0, ROOM_UJ);
    let after = settle(battery, asked, offered, capacity);
    kani::cover!(after.battery_uj == 0 && battery > 0, "runs empty");
    kani::cover!(
        after.battery_uj == capacity && battery < capacity,
        "charges to full"
    );
    kani::cover!(after.shortfall_uj > 0, "asks for more than there is");
    balances(battery, asked, offered, capacity);
}

/// `settle` keeps the contract that the end of a step relies on in its place.
#[cfg_attr(kani, kani::proof_for_contract(crate::rules::energy::settle))]
pub fn settling_keeps_its_contract() {
    let capacity = between(0, ROOM_UJ);
    let battery = between(0, capacity);
    let (asked, offered) = (between(0, ROOM_UJ), between(0, ROOM_UJ));
    let after = settle(battery, asked, offered, capacity);
    kani::cover!(
        after.accepted_uj > 0 && after.spent_uj > 0,
        "spends and charges"
    );
    assert!(after.balances(battery, asked, offered, capacity));
}

/// No activity at any pilot density asks for more than the plan's most.
fn asks_at_most(plan: &EnergyConstants, activity: Activity, pilot_density: f64) {
    let asked = plan.asked_uj(activity, pilot_density);
    assert!(asked <= plan.most_asked_uj());
    if activity.flies == 0 {
        assert!(asked == 0);
    }
}

#[cfg_attr(kani, kani::proof)]
pub fn no_step_asks_for_more_than_planned() {
    let plan = EnergyConstants::new(&Config::default());
    let activity = Activity {
        flies: ones(kani::any()),
        moved: ones(kani::any()),
        sensing: ones(kani::any()),
        linked: ones(kani::any()),
    };
    let pilot_density = real_between(0.0, 1.0);
    let asked = plan.asked_uj(activity, pilot_density);
    kani::cover!(activity.flies == 0, "a grounded UAV");
    kani::cover!(asked > plan.move_uj, "more than the move");
    asks_at_most(&plan, activity, pilot_density);
}

#[cfg(not(kani))]
super::standin::twins! {
    battery_ledger_balances: 4000 cases, 3 covers;
    settling_keeps_its_contract: 2000 cases, 1 covers;
    no_step_asks_for_more_than_planned: 2000 cases, 2 covers;
}
