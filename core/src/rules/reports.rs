//! Reports: in which cells UAVs have seen hotspots, and how often.
//!
//! A UAV keeps one set of cells for each level. Level ℓ of its own sightings has the cells in which
//! it saw a hotspot, true or false, in at least ℓ steps. Level ℓ of its reports has the cells in
//! which some UAV, as far as it knows, did so. Reports spread over the radio graph as knowledge
//! does ([`crate::rules::knowledge::consensus`]).

use crate::config::Cell;
use crate::model::Model;
use crate::state::{StateMut, StateRef};
use crate::words::bits;

/// Adds the detections and the false alarms of the step to each UAV's sightings and reports.
// Proof: proofs/reports.rs, a_sighting_raises_one_cell_by_one_level
pub(crate) fn sight(model: &Model<'_>, state: &mut StateMut<'_>) {
    let row = model.layout().reports;
    if row == 0 {
        return;
    }
    let (hotspots, words) = (model.hotspot_words(), model.layout().false_cells);
    let alarms = state.false_alarms.chunks_exact(model.layout().alarms);
    let own = state.sightings.chunks_exact_mut(row);
    let known = state.reports.chunks_exact_mut(row);
    let detected = state.detected.chunks_exact(hotspots);
    for ((own, known), (detected, alarms)) in own.zip(known).zip(detected.zip(alarms)) {
        for j in bits::iter(detected) {
            let cell = model.cell_index(Cell::from_word(state.hotspots[j]));
            raise(own, known, words, cell);
        }
        for &alarm in alarms {
            if alarm > 0 {
                raise(own, known, words, alarm as usize - 1);
            }
        }
    }
}

/// Adds a cell to the lowest level of a UAV's sightings that lacks it, and to the same level of its
/// reports. Nothing changes if every level has the cell.
///
/// Both slices hold a set of `words` words for each level, from level 1.
// Proof: proofs/reports.rs, a_sighting_raises_one_cell_by_one_level
#[inline]
pub fn raise(own: &mut [u64], known: &mut [u64], words: usize, cell: usize) {
    let levels = own.chunks_exact_mut(words);
    for (own, known) in levels.zip(known.chunks_exact_mut(words)) {
        if !bits::get(own, cell) {
            bits::set(own, cell);
            bits::set(known, cell);
            return;
        }
    }
}

/// The most reported cells of an observation.
pub(crate) const SLOTS_MAX: usize = 64;

/// Bits of a cell's index in a sorting key; squared distances take the bits above.
const INDEX_BITS: u32 = 20;

/// The cells that UAV `i` knows a report of and that no quorum has confirmed, truly or falsely.
///
/// They come nearest first, ties in row-major order. There are at most `slots` of them, and at most
/// 64.
pub(crate) fn nearest(
    model: &Model<'_>,
    state: &StateRef<'_>,
    i: usize,
    slots: usize,
) -> ([Cell; SLOTS_MAX], usize) {
    let own = state.cell(i);
    let width = model.config().grid_width;
    let (mut keys, mut count) = ([u64::MAX; SLOTS_MAX], 0);
    let words = model.layout().false_cells;
    for index in bits::iter(&state.reports_of(i)[..words]) {
        let there = at(index, width);
        let (dx, dy) = (there.x.abs_diff(own.x), there.y.abs_diff(own.y));
        let key = u64::from(dx * dx + dy * dy) << INDEX_BITS | index as u64;
        if key < keys[slots - 1] && !is_settled(model, state, index) {
            insert(&mut keys[..slots], key);
            count += usize::from(count < slots);
        }
    }
    let mask = (1 << INDEX_BITS) - 1;
    (keys.map(|key| at((key & mask) as usize, width)), count)
}

/// Puts a key in its place among ascending ones and drops the last.
fn insert(keys: &mut [u64], key: u64) {
    let mut slot = keys.len() - 1;
    while slot > 0 && keys[slot - 1] > key {
        keys[slot] = keys[slot - 1];
        slot -= 1;
    }
    keys[slot] = key;
}

const fn at(index: usize, width: u32) -> Cell {
    Cell {
        x: index as u32 % width,
        y: index as u32 / width,
    }
}

/// Whether a quorum has confirmed the cell, truly or falsely.
fn is_settled(model: &Model<'_>, state: &StateRef<'_>, index: usize) -> bool {
    let mut settled = state.falsely_confirmed(index);
    for j in 0..state.hotspot_count() {
        settled |= state.confirmed(j) && model.cell_index(state.hotspot_cell(j)) == index;
    }
    settled
}

#[cfg(all(test, feature = "alloc"))]
mod tests {
    use super::*;
    use crate::{Config, Sim};
    use std::vec;
    use std::vec::Vec;

    /// A fleet of two that stays on one depot; its footprint is the UAV's own cell.
    fn config() -> Config {
        Config {
            uav_count: 2,
            hotspot_count: 1,
            quorum: 3,
            false_alarm_per_cell: 0.01,
            sensing_footprint_m: Some(0.0),
            report_levels: 2,
            report_slots: 4,
            ..Config::default()
        }
    }

    /// Positives raise a UAV's own levels; others hear of them over the graph, and do not add to
    /// them.
    #[test]
    fn levels_count_the_sightings_of_one_uav() {
        let model = Model::new(config()).unwrap();
        let mut sim = Sim::new(&model);
        sim.set_hotspots(&[Cell { x: 4, y: 5 }]).unwrap();
        let at_hotspot = 5 * 12 + 4;
        let mut levels = Vec::new();
        for (detections, links) in [([1, 0], 0), ([0, 1], 1), ([0, 1], 0), ([1, 1], 1)] {
            sim.step_begin(&[0.0; 4]).unwrap();
            sim.step_sense_with(&detections).unwrap();
            sim.step_communicate_with(&[0, links, links, 0], None)
                .unwrap();
            sim.step_end().unwrap();
            let state = sim.state();
            levels.push([0, 1].map(|i| state.report_level(i, at_hotspot)));
            assert!(state.is_valid(&model));
        }
        assert_eq!(levels, [[1, 0], [1, 1], [1, 2], [2, 2]]);
    }

    /// The list of an observation: nearest first, ties in row-major order, without confirmed cells.
    #[test]
    fn the_nearest_reported_cells_come_first() {
        let model = Model::new(Config {
            hotspot_count: 4,
            ..config()
        })
        .unwrap();
        let mut sim = Sim::new(&model);
        let cells = [(9, 6), (6, 7), (5, 6), (6, 8)].map(|(x, y)| Cell { x, y });
        sim.set_hotspots(&cells).unwrap();
        sim.step_begin(&[0.0; 4]).unwrap();
        sim.set_positions(&[Cell { x: 6, y: 6 }; 2]).unwrap();
        sim.confirm_hotspot(1).unwrap();
        sim.step_sense_with(&[1, 1, 1, 1, 0, 0, 0, 0]).unwrap();
        sim.step_communicate_with(&[0; 4], None).unwrap();
        sim.step_end().unwrap();
        let (found, count) = nearest(&model, &sim.state(), 0, 2);
        assert_eq!(found[..count], [cells[2], cells[3]]);
        let mut observed = vec![0.0; 2 * model.observation_len()];
        sim.observe(&mut observed).unwrap();
        let list = model.observation_len() - 12;
        let spans = [
            -1.0 / 11.0,
            0.0,
            0.5,
            0.0,
            2.0 / 11.0,
            0.5,
            3.0 / 11.0,
            0.0,
            0.5,
        ];
        assert_eq!(
            observed[list..list + 9],
            spans.map(|entry: f64| entry as f32)
        );
        assert_eq!(observed[list + 9..list + 12], [0.0; 3]);
    }
}
