//! Sense and learn: independent detections, the quorum that confirms, who knows at once.

use crate::bits;
use crate::config::Cell;
use crate::model::Model;
use crate::radar;
use crate::rng::{self, Purpose};
use crate::scratch::Scratch;
use crate::state::StateMut;

/// Hotspots whose draws share a block of the generator.
const LANES: usize = 4;

/// Draws a detection for every UAV that is not grounded and every hotspot that it does not know;
/// confirms hotspots with at least θ positives; UAVs learn what they detected and is confirmed.
pub(crate) fn sense_and_learn(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
) {
    let (detected, positives) = scratch.detections(model);
    detect(model, state, detected, positives);
    state.detected.copy_from_slice(detected);
    conclude(model, state, positives);
}

/// As [`sense_and_learn`] with the host's detections, a row of hotspots for each UAV, in place of the
/// draws. A UAV asks for nothing where it is grounded or knows the hotspot.
pub(crate) fn learn_from(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
    detections: &[u8],
) {
    let positives = scratch.list(model.hotspot_count());
    positives.fill(0);
    state.detected.fill(0);
    let (row, hotspots) = (model.hotspot_words(), model.hotspot_count());
    for i in 0..model.uav_count() {
        let known = &state.knowledge[i * row..(i + 1) * row];
        let senses = !bits::get(state.grounded, i) && bits::count(known) < hotspots;
        bits::assign(state.sensing, i, senses);
        if !senses {
            continue;
        }
        for j in 0..hotspots {
            if detections[i * hotspots + j] != 0 && !bits::get(known, j) {
                bits::set(&mut state.detected[i * row..(i + 1) * row], j);
                positives[j] += 1;
            }
        }
    }
    conclude(model, state, positives);
}

/// Confirms by quorum; UAVs learn what they detected and is confirmed.
fn conclude(model: &Model<'_>, state: &mut StateMut<'_>, positives: &[u64]) {
    confirm(model, state, positives);
    learn(state.knowledge, state.detected, state.confirmed);
}

fn detect(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    detected: &mut [u64],
    positives: &mut [u64],
) {
    detected.fill(0);
    positives.fill(0);
    let (row, hotspots) = (model.hotspot_words(), model.hotspot_count());
    for i in 0..model.uav_count() {
        let known = &state.knowledge[i * row..(i + 1) * row];
        let senses = !bits::get(state.grounded, i) && bits::count(known) < hotspots;
        bits::assign(state.sensing, i, senses);
        if senses {
            let found = &mut detected[i * row..(i + 1) * row];
            detect_from(model, state, i, found, positives);
        }
    }
}

/// The draws of one UAV: a block of the generator for every four hotspots.
fn detect_from(
    model: &Model<'_>,
    state: &StateMut<'_>,
    i: usize,
    found: &mut [u64],
    positives: &mut [u64],
) {
    let (seed, t) = (state.header.seed(), state.header.t());
    let (cell, load) = (state.cell(i), 1.0 - state.pilot_density(i));
    let load_odds = radar::load_odds_against(model.loss_per_load(), load);
    let range_odds = model.range_odds();
    let known = &state.knowledge[i * found.len()..(i + 1) * found.len()];
    let cells = state.hotspots.chunks(LANES);
    for (block, (cells, positives)) in cells.zip(positives.chunks_mut(LANES)).enumerate() {
        let first = block * LANES;
        let unknown = !known[first / 64] >> (first % 64) & 0xF;
        if unknown == 0 {
            continue;
        }
        let draws = rng::block(seed, t, i as u32, block as u32, Purpose::Detect);
        let mut hits = 0;
        for lane in 0..cells.len() {
            let range_odds = range_odds.between(cell, Cell::from_word(cells[lane]));
            let odds = radar::odds_against(range_odds, load_odds);
            let below = u64::from(draws[lane]) < radar::detection_threshold(odds);
            let positive = unknown >> lane & u64::from(below);
            positives[lane] += positive;
            hits |= positive << lane;
        }
        found[first / 64] |= hits << (first % 64);
    }
}

fn confirm(model: &Model<'_>, state: &mut StateMut<'_>, positives: &[u64]) {
    let (t, quorum) = (state.header.t(), u64::from(model.config().quorum));
    for j in 0..model.hotspot_count() {
        if confirms(bits::get(state.confirmed, j), positives[j], quorum) {
            bits::set(state.confirmed, j);
            state.detected_at[j] = u64::from(t);
        }
    }
}

/// Whether this step confirms a hotspot: it was not confirmed before, and at least θ UAVs detect it.
#[inline]
#[must_use]
pub const fn confirms(confirmed: bool, positives: u64, quorum: u64) -> bool {
    !confirmed && positives >= quorum
}

/// k_ij becomes 1 where UAV i detected j and j is confirmed.
pub fn learn(knowledge: &mut [u64], detected: &[u64], confirmed: &[u64]) {
    let row = confirmed.len();
    for index in 0..knowledge.len() {
        knowledge[index] |= detected[index] & confirmed[index % row];
    }
}
