//! Sense and learn: independent detections, the quorum that confirms, who knows at once.

use crate::bits;
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
    confirm(model, state, positives);
    learn(state.knowledge, detected, state.confirmed);
}

fn detect(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    detected: &mut [u64],
    positives: &mut [u64],
) {
    detected.fill(0);
    positives.fill(0);
    let (seed, t) = (state.header.seed(), state.header.t());
    let (row, hotspots) = (model.hotspot_words(), model.hotspot_count());
    for i in 0..model.uav_count() {
        let known = &state.knowledge[i * row..(i + 1) * row];
        let senses = !bits::get(state.grounded, i) && bits::count(known) < hotspots;
        bits::assign(state.sensing, i, senses);
        if !senses {
            continue;
        }
        let cell = state.cell(i);
        let load_odds =
            radar::load_odds_against(model.loss_per_load(), 1.0 - state.pilot_density(i));
        for block in 0..hotspots.div_ceil(LANES) {
            let first = block * LANES;
            let unknown = !known[first / 64] >> (first % 64) & 0xF;
            if unknown == 0 {
                continue;
            }
            let draws = rng::block(seed, t, i as u32, block as u32, Purpose::Detect);
            let lanes = if hotspots - first < LANES {
                hotspots - first
            } else {
                LANES
            };
            for lane in 0..lanes {
                let j = first + lane;
                let range_odds = model.range_odds_against(cell, state.hotspot_cell(j));
                let threshold = radar::detection_threshold(range_odds * load_odds);
                let positive = unknown >> lane & u64::from(u64::from(draws[lane]) < threshold);
                positives[j] += positive;
                detected[i * row + j / 64] |= positive << (j % 64);
            }
        }
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
