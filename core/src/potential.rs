//! The potentials of reward shaping (A. Y. Ng, D. Harada, S. Russell, ICML 1999): they speed up learning
//! without changing which policy is best.

use crate::bits;
use crate::config::Cell;
use crate::model::Model;
use crate::scratch::Scratch;
use crate::state::StateMut;

/// Works out both potentials of the present state and stores them; both are 0 in a terminal state.
pub(crate) fn update(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
    terminal: bool,
) {
    let (goal, charge) = if terminal {
        (0.0, 0.0)
    } else {
        (goal(model, state, scratch), charge(model, state))
    };
    state.header.set_goal_potential(goal);
    state.header.set_charge_potential(charge);
}

/// Whether two potentials can be those of a state: each within its weight, but for rounding.
pub(crate) fn is_in_range(model: &Model<'_>, goal: f64, charge: f64) -> bool {
    let config = model.config();
    let slack = 1.000_001;
    goal >= -config.shaping_goal_weight * slack
        && goal <= 0.0
        && charge >= 0.0
        && charge <= config.shaping_charge_weight * slack
}

/// Longest Manhattan distance on the grid, W + H - 2, at least 1.
fn span(model: &Model<'_>) -> f64 {
    let config = model.config();
    f64::from(
        (config.grid_width + config.grid_height)
            .saturating_sub(2)
            .max(1),
    )
}

/// Φ = -w_g · mean over UAVs of the Manhattan distance to the nearest unconfirmed hotspot / (W + H - 2).
fn goal(model: &Model<'_>, state: &StateMut<'_>, scratch: &mut Scratch<'_>) -> f64 {
    let open = scratch.list(model.hotspot_count());
    let mut count = 0;
    for j in 0..model.hotspot_count() {
        if !bits::get(state.confirmed, j) {
            open[count] = state.hotspots[j];
            count += 1;
        }
    }
    if count == 0 {
        return 0.0;
    }
    let mut total = 0u64;
    for i in 0..model.uav_count() {
        let cell = state.cell(i);
        let mut nearest = u32::MAX;
        for &word in &open[..count] {
            let distance = cell.manhattan(Cell::from_word(word));
            nearest = if distance < nearest {
                distance
            } else {
                nearest
            };
        }
        total += u64::from(nearest);
    }
    let mean = total as f64 / model.uav_count() as f64;
    -(model.config().shaping_goal_weight * (mean / span(model)))
}

/// Φ = w_c · mean over UAVs of (1 - soc_i) · g_t · (1 - depot distance / (W + H - 2)), with
/// g_t = ρ_RE + (1 - ρ_RE) · (c_max - c_t)/(c_max - c_min).
fn charge(model: &Model<'_>, state: &StateMut<'_>) -> f64 {
    let (capacity_uj, span) = (model.energy().capacity_uj, span(model));
    let mut sum = 0.0;
    for i in 0..model.uav_count() {
        let missing = (capacity_uj - state.battery[i]) as f64;
        let distance = f64::from(model.depot_distance(state.cell(i)));
        sum += missing * (span - distance);
    }
    let mean = sum / (capacity_uj as f64 * span * model.uav_count() as f64);
    let config = model.config();
    let cleanness = 1.0
        - model
            .carbon()
            .normalised(state.header.intensity_mg_per_kwh());
    let g = config.renewable_share + (1.0 - config.renewable_share) * cleanness;
    config.shaping_charge_weight * (mean * g)
}
