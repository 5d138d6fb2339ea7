//! `myopic`: the pilot density that promises most for the next step alone.

use jcas_core::{Cell, Model, StateRef, TargetVisibility};

use super::steering::{cell_of, settled};

/// The number of pilot densities that are compared, spread evenly from minimum to maximum.
const LEVELS: usize = 5;
/// The probability of a detection at ρ_max below which a cell is not looked at.
const LEAST_PROBABILITY: f64 = 1e-3;
/// The probability of a detection at the edge of the footprint, which is the least inside.
const AT_THE_EDGE: f64 = 0.5;

/// Returns the pilot density with the most expected detections and neighbours reached, and the
/// least one among equals.
///
/// A UAV in cell a expects D(ρ) = Σ b_c p(ρ, c - a) detections, the sum over the cells c. Here b_c
/// is the chance of an unconfirmed hotspot in c ([`chance`]). It reaches R(ρ) UAVs: those that hear
/// it at ρ and whose knowledge or reports differ from its own. The rule maximises D(ρ) + R(ρ).
pub(super) fn density(model: &Model<'_>, state: &StateRef<'_>, uav: usize) -> f64 {
    let (low, high) = (
        model.config().pilot_density_min,
        model.config().pilot_density_max,
    );
    let step = (high - low) / (LEVELS - 1) as f64;
    let densities: [f64; LEVELS] = core::array::from_fn(|level| low + step * level as f64);
    let here = state.cell(uav);
    let mut worth = [0.0; LEVELS];
    let different = (0..model.uav_count()).filter(|&other| knows_otherwise(state, uav, other));
    for other in different {
        let (dx, dy) = offset(here, state.cell(other));
        for (worth, density) in worth.iter_mut().zip(densities) {
            let throughput = model.link_throughput(dx, dy, density);
            *worth += f64::from(u8::from(throughput >= model.config().link_throughput_min));
        }
    }
    let seen = |cell: Cell| {
        let (dx, dy) = offset(here, cell);
        model.detection_probability(dx, dy, high) >= LEAST_PROBABILITY
    };
    add_detections(model, state, uav, seen, |cell, chance| {
        let (dx, dy) = offset(here, cell);
        for (worth, density) in worth.iter_mut().zip(densities) {
            *worth += chance * model.detection_probability(dx, dy, density);
        }
    });
    let mut best = 0;
    for level in 1..LEVELS {
        if worth[level] > worth[best] {
            best = level;
        }
    }
    densities[best]
}

/// Calls `add` with each cell within reach that may hold an unconfirmed hotspot, and with the
/// chance of that. `seen` says whether a cell is within reach.
fn add_detections(
    model: &Model<'_>,
    state: &StateRef<'_>,
    uav: usize,
    seen: impl Fn(Cell) -> bool,
    mut add: impl FnMut(Cell, f64),
) {
    let config = model.config();
    let left = model.hotspot_count() - state.confirmed_count();
    if left == 0 {
        return;
    }
    if config.target_visibility == TargetVisibility::Known {
        let unconfirmed = (0..model.hotspot_count()).filter(|&j| !state.confirmed(j));
        for cell in unconfirmed
            .map(|j| state.hotspot_cell(j))
            .filter(|&cell| seen(cell))
        {
            add(cell, 1.0);
        }
        return;
    }
    let open = (0..config.cell_count()).filter(|&index| !state.searched(uav, index));
    let share = left as f64 / open.count().max(left) as f64;
    for index in 0..config.cell_count() {
        let cell = cell_of(model, index);
        if !seen(cell) {
            continue;
        }
        let level = state.report_level(uav, index);
        if (level > 0 || !state.searched(uav, index)) && !settled(state, index, cell) {
            add(cell, chance(share, level, config.false_alarm_per_cell));
        }
    }
}

/// Returns the chance of a hotspot in a cell with a report of this level.
///
/// The prior is the number of unconfirmed hotspots over that of cells not searched. Each level
/// multiplies its odds by [`AT_THE_EDGE`] over the probability of a false alarm.
fn chance(prior: f64, level: u32, false_alarm: f64) -> f64 {
    let mut odds = prior / (1.0 - prior);
    for _ in 0..level {
        odds *= AT_THE_EDGE / false_alarm;
    }
    if odds.is_finite() {
        odds / (1.0 + odds)
    } else {
        1.0
    }
}

/// Returns whether another UAV knows other hotspots or reports.
fn knows_otherwise(state: &StateRef<'_>, uav: usize, other: usize) -> bool {
    other != uav
        && (state.knowledge_of(uav) != state.knowledge_of(other)
            || state.reports_of(uav) != state.reports_of(other))
}

fn offset(a: Cell, b: Cell) -> (u32, u32) {
    (a.x.abs_diff(b.x), a.y.abs_diff(b.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use jcas_core::{Config, Preset, Sim};

    /// Two positives at odds of 50 to 1 each outweigh a prior of one cell in a hundred.
    #[test]
    fn each_level_multiplies_the_odds() {
        assert!((chance(0.01, 0, 0.01) - 0.01).abs() < 1e-15);
        let odds = 2500.0 / 99.0;
        assert!((chance(0.01, 2, 0.01) - odds / (1.0 + odds)).abs() < 1e-12);
        assert_eq!(chance(0.01, 1, 0.0), 1.0);
        assert_eq!(chance(1.0, 0, 0.01), 1.0);
    }

    /// A fleet on its depot knows nothing apart, so that only detections count. Without hotspots
    /// left to find, nothing counts and the least density is taken.
    #[test]
    fn a_fleet_that_knows_the_same_looks_and_one_that_found_all_does_not() {
        let config = Config::preset(Preset::Isac);
        let model = Model::new(config).unwrap();
        let mut sim = Sim::new(&model);
        sim.reset(3);
        let got = density(&model, &sim.state(), 0);
        assert!((got - config.pilot_density_max).abs() < 1e-12, "{got}");
        let done = Config {
            quorum: 1,
            hotspot_count: 1,
            grid_width: 2,
            grid_height: 2,
            ..config
        };
        let model = Model::new(done).unwrap();
        let mut sim = Sim::new(&model);
        sim.reset(3);
        let stay = vec![0.0; model.action_len()];
        while !sim.state().terminated() {
            sim.step(&stay).unwrap();
        }
        assert_eq!(density(&model, &sim.state(), 0), done.pilot_density_min);
    }
}
