//! A check that a battery lasts for a trajectory.

use jcas_core::energy::settle;
use jcas_core::motion::{destination, nearest, toward};
use jcas_core::{Cell, Model};

use crate::odds::Odds;

/// The kernel's treatment of a UAV in a step, given its charge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Duty {
    /// The UAV follows its action.
    Free,
    /// A low battery sends the UAV to this cell.
    Returns(Cell),
    /// An empty battery keeps the UAV where it is.
    Grounded,
}

pub(crate) fn duty(model: &Model<'_>, charge_uj: u64, cell: Cell) -> Duty {
    if charge_uj == 0 {
        return Duty::Grounded;
    }
    if charge_uj >= model.energy().rtb_uj {
        return Duty::Free;
    }
    let config = model.config();
    let depot = model.depots()[nearest(cell, model.depots()).0];
    let motion = toward(cell, depot);
    Duty::Returns(destination(
        cell,
        motion,
        config.grid_width,
        config.grid_height,
    ))
}

/// Returns the charge after a step in µJ, if the UAV senses and has a neighbour, the most costly
/// case.
pub(crate) fn after(
    model: &Model<'_>,
    charge_uj: u64,
    from: Cell,
    to: Cell,
    pilot_density: f64,
) -> u64 {
    let plan = model.energy();
    let offered_uj = if model.depots().contains(&to) {
        plan.charge_uj
    } else {
        0
    };
    let asked_uj = if charge_uj == 0 {
        0
    } else {
        plan.most_asked_at_uj(from != to, pilot_density)
    };
    settle(charge_uj, asked_uj, offered_uj, plan.capacity_uj).battery_uj
}

/// Returns whether a UAV with this charge can fly a trajectory, given as in
/// [`Paths`](crate::Paths).
///
/// A low battery never sends it elsewhere. Its level is [`Odds::grounded`] in exactly the steps
/// that it begins with an empty battery.
#[must_use]
pub fn allows(
    model: &Model<'_>,
    odds: &Odds,
    charge_uj: u64,
    cells: &[u32],
    levels: &[u8],
) -> bool {
    let mut charge_uj = charge_uj;
    for (pair, &level) in cells.windows(2).zip(&levels[1..]) {
        let (from, to) = (odds.cell(pair[0]), odds.cell(pair[1]));
        let legal = match duty(model, charge_uj, from) {
            Duty::Free => level != odds.grounded(),
            Duty::Returns(there) => level != odds.grounded() && to == there,
            Duty::Grounded => level == odds.grounded() && to == from,
        };
        if !legal {
            return false;
        }
        let density = odds.densities().get(usize::from(level)).copied();
        charge_uj = after(model, charge_uj, from, to, density.unwrap_or(0.0));
    }
    true
}

/// Returns whether no trajectory of this length drains a battery below the return-to-base
/// threshold.
pub(crate) fn never_low(model: &Model<'_>, charge_uj: u64, steps: usize) -> bool {
    let plan = model.energy();
    let most = (steps as u64).saturating_mul(plan.most_asked_uj());
    charge_uj > most && charge_uj - most >= plan.rtb_uj
}
