//! The potentials of reward shaping (A. Y. Ng, D. Harada, S. Russell, ICML 1999): they speed up
//! learning without changing which policy is best.

use crate::config::Cell;
use crate::lanes::{self, Block, Cells, Lanes, at_width};
use crate::model::Model;
use crate::state::StateMut;
use crate::state::scratch::{Scratch, UavStepScratch};
use crate::words::bits;
use crate::words::word::canonical_bits;

/// Computes and stores both potentials of each UAV and their means; all are 0 in a terminal state.
#[inline(always)]
pub(crate) fn update(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
    terminal: bool,
) {
    let (goal, charge) = if terminal {
        for i in 0..model.uav_count() {
            state.set_goal_potential(i, 0.0);
            state.set_charge_potential(i, 0.0);
        }
        (0.0, 0.0)
    } else {
        at_width!(model, both(model, state, scratch))
    };
    state.header.set_goal_potential(goal);
    state.header.set_charge_potential(charge);
}

/// Saves the potentials of each UAV from before the step.
#[inline(always)]
pub(crate) fn save(model: &Model<'_>, state: &StateMut<'_>, per_uav: &mut UavStepScratch<'_>) {
    at_width!(model, save_in_blocks(model, state, per_uav));
}

#[inline(always)]
fn save_in_blocks<const W: usize>(
    model: &Model<'_>,
    state: &StateMut<'_>,
    per_uav: &mut UavStepScratch<'_>,
) {
    for block in lanes::blocks::<W>(model.uav_count()) {
        block.store(&block.load(state.goal_potential), per_uav.goal_before);
        block.store(&block.load(state.charge_potential), per_uav.charge_before);
    }
}

/// Computes the goal potential and the charging potential.
#[inline(always)]
fn both<const W: usize>(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
) -> (f64, f64) {
    (goal::<W>(model, state, scratch), charge::<W>(model, state))
}

/// Longest Manhattan distance on the grid, W + H - 2, at least 1.
#[inline(always)]
fn span(model: &Model<'_>) -> f64 {
    let config = model.config();
    f64::from(
        (config.grid_width + config.grid_height)
            .saturating_sub(2)
            .max(1),
    )
}

/// Φ_i = -w_g · (Manhattan distance to the nearest unconfirmed hotspot / (W + H - 2) + w_u · U),
/// with U the number of unconfirmed hotspots. It is 0 if U is 0. Returns the mean over the fleet.
///
/// After a confirmation the next hotspot may be as far away as the grid allows, but U is less by 1.
/// So a confirmation lowers no potential if w_u is at least 1.
#[inline(always)]
fn goal<const W: usize>(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
) -> f64 {
    let open = scratch.list(model.hotspot_count());
    let mut count = 0;
    for j in 0..model.hotspot_count() {
        if !bits::get(state.confirmed, j) {
            open[count] = state.hotspots[j];
            count += 1;
        }
    }
    let config = model.config();
    let (weight, span) = (config.shaping_goal_weight, span(model));
    let unconfirmed = config.shaping_unconfirmed_weight * count as f64;
    let mut total = 0u64;
    for block in lanes::blocks::<W>(model.uav_count()) {
        let nearest = nearest(block, state, &open[..count]);
        let mut potentials = [0; W];
        for lane in 0..W {
            let distance = f64::from(nearest[lane]);
            potentials[lane] = canonical_bits(-(weight * (distance / span + unconfirmed)));
        }
        let (mut sum, own) = (0, block.mask() as i32);
        for lane in 0..W {
            sum += nearest[lane] & -(own >> lane & 1);
        }
        total += sum as u64;
        block.store(&potentials, state.goal_potential);
    }
    let mean = total as f64 / model.uav_count() as f64;
    -(weight * (mean / span + unconfirmed))
}

/// Manhattan distance of each UAV of a block to the nearest open hotspot; 0 without open hotspots.
#[inline(always)]
fn nearest<const W: usize>(block: Block<W>, state: &StateMut<'_>, open: &[u64]) -> Lanes<i32, W> {
    let cells = Cells::load(block, state.cells);
    let mut nearest = [if open.is_empty() { 0 } else { i32::MAX }; W];
    for &word in open {
        let to = Cell::from_word(word);
        let (x, y) = (to.x as i32, to.y as i32);
        for lane in 0..W {
            let distance = (cells.x[lane] - x).abs() + (cells.y[lane] - y).abs();
            nearest[lane] = nearest[lane].min(distance);
        }
        // The vectors run over UAVs, with one hotspot at a time.
        lanes::force_vector(&mut nearest);
    }
    nearest
}

/// Φ_i = w_c · (1 - soc_i) · g_t · (1 - depot distance / (W + H - 2)), with
/// g_t = ρ_RE + (1 - ρ_RE) · (c_max - c_t)/(c_max - c_min). Returns the mean.
#[inline(always)]
fn charge<const W: usize>(model: &Model<'_>, state: &mut StateMut<'_>) -> f64 {
    let (capacity_uj, span) = (model.energy().capacity_uj, span(model));
    let config = model.config();
    let cleanness = 1.0
        - model
            .carbon()
            .normalised(state.header.intensity_mg_per_kwh());
    let g = config.renewable_share + (1.0 - config.renewable_share) * cleanness;
    let (weight, most) = (config.shaping_charge_weight, capacity_uj as f64 * span);
    let mut sum = 0.0;
    for block in lanes::blocks::<W>(model.uav_count()) {
        let battery = block.load(state.battery);
        let depots = model.depot_distances(&Cells::load(block, state.cells));
        let (mut shares, mut potentials) = ([0.0; W], [0; W]);
        for lane in 0..W {
            let missing = capacity_uj.wrapping_sub(battery[lane]) as f64;
            shares[lane] = missing * (span - f64::from(depots[lane] as i32));
            potentials[lane] = canonical_bits(weight * (shares[lane] / most * g));
        }
        for shares in block.in_order(&shares) {
            for share in shares {
                sum += share;
            }
        }
        block.store(&potentials, state.charge_potential);
    }
    let mean = sum / (most * model.uav_count() as f64);
    weight * (mean * g)
}
