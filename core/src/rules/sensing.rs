//! Sensing and learning: search maps, independent detections, the quorum that confirms a hotspot,
//! and the UAVs that learn it.

use crate::config::{Cell, LearnedDetections};
use crate::lanes::{self, Block, Cells, Lanes, at_width};
use crate::model::Model;
use crate::radio::radar::curve::{AnyCurve, Curve};
use crate::state::StateMut;
use crate::state::scratch::Scratch;
use crate::words::bits;
use crate::words::rng::{self, Purpose};

/// Number of hotspots whose draws share a block of the generator.
const DRAWS: usize = 4;

/// Adds the cells within the search radius of each UAV to its map, except for grounded UAVs.
pub(crate) fn look_around(model: &Model<'_>, state: &mut StateMut<'_>) {
    let row = model.map_words();
    if row == 0 {
        return;
    }
    let (width, height) = (model.config().grid_width, model.config().grid_height);
    for i in 0..model.uav_count() {
        if !bits::get(state.grounded, i) {
            let cell = state.cell(i);
            let map = &mut state.searched[i * row..(i + 1) * row];
            model.disc().mark(map, cell, width, height);
        }
    }
}

/// Draws a detection for every UAV that is not grounded and every hotspot that it does not know or
/// that is not confirmed.
///
/// Hotspots with at least θ positive detections are confirmed. A UAV learns the confirmed hotspots
/// that it detected; or all that it detected, if `learned_detections` says so.
// Proof: proofs/step.rs, sensing_keeps_the_state_valid
#[inline(always)]
pub(crate) fn sense_and_learn(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
) {
    let positives = scratch.list(model.hotspot_count());
    positives.fill(0);
    match model.curve() {
        AnyCurve::Logistic(curve) => {
            at_width!(model, detect_in_blocks(curve, model, state, positives))
        }
        AnyCurve::Coherent(curve) => {
            at_width!(model, detect_in_blocks(curve, model, state, positives))
        }
        AnyCurve::Swerling1(curve) => {
            at_width!(model, detect_in_blocks(curve, model, state, positives))
        }
    }
    confirm_and_learn(model, state, positives);
}

/// Does the same as [`sense_and_learn`] with the host's detections, a row of hotspots for each UAV.
/// A detection is ignored if the UAV is grounded, or knows the hotspot and it is confirmed.
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
        let mut senses = false;
        for j in 0..hotspots {
            let settled = bits::get(known, j) && bits::get(state.confirmed, j);
            if settled || bits::get(state.grounded, i) {
                continue;
            }
            senses = true;
            if detections[i * hotspots + j] != 0 {
                bits::set(&mut state.detected[i * row..(i + 1) * row], j);
                positives[j] += 1;
            }
        }
        bits::assign(state.sensing, i, senses);
    }
    confirm_and_learn(model, state, positives);
}

/// Confirms hotspots by quorum. Each UAV learns of the hotspots that it detected.
// Proof: proofs/step.rs, learning_with_memory_keeps_the_state_valid
#[inline(always)]
pub(crate) fn confirm_and_learn(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    positives: &mut [u64],
) {
    let counts_episode = model.layout().remembered > 0;
    if counts_episode {
        remember(state.remembered, state.detected);
        count_rows(state.remembered, model.layout().remembered, positives);
    }
    confirm(model, state, positives);
    match model.config().learned_detections {
        LearnedDetections::All => remember(state.knowledge, state.detected),
        LearnedDetections::Confirmed if counts_episode => {
            learn(state.knowledge, state.remembered, state.confirmed);
        }
        LearnedDetections::Confirmed => learn(state.knowledge, state.detected, state.confirmed),
    }
}

/// Adds each UAV's detections to a set that it keeps, word by word.
// Proof: proofs/knowledge.rs, a_remembered_detection_counts_once
pub fn remember(kept: &mut [u64], detected: &[u64]) {
    for (kept, detected) in kept.iter_mut().zip(detected) {
        *kept |= detected;
    }
}

/// Counts, for each bit, the rows of `row` words that have it.
// Proof: proofs/knowledge.rs, a_remembered_detection_counts_once
pub fn count_rows(rows: &[u64], row: usize, counts: &mut [u64]) {
    counts.fill(0);
    for set in rows.chunks_exact(row) {
        for (j, count) in counts.iter_mut().enumerate() {
            *count += u64::from(bits::get(set, j));
        }
    }
}

#[inline(always)]
fn detect_in_blocks<const W: usize>(
    curve: &impl Curve,
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    positives: &mut [u64],
) {
    for block in lanes::blocks::<W>(model.uav_count()) {
        detect_in(curve, model, state, block, positives);
    }
}

/// Draws the detections of a block's UAVs, with one block of the generator for four hotspots.
#[inline(always)]
fn detect_in<const W: usize>(
    curve: &impl Curve,
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    block: Block<W>,
    positives: &mut [u64],
) {
    let (row, seed, t) = (model.hotspot_words(), state.header.seed(), state.header.t());
    let flies = lanes::spread::<W>(!block.bits(state.grounded) & block.mask());
    let rows = Cells::load(block, state.cells).rows(model.config().grid_width);
    let factors = factors(curve, &block.load(state.pilot));
    let uavs = block.indices().map(|index| block.first as u32 + index);
    let mut wanting = [0; W];
    let words = state.hotspots.chunks(64).zip(positives.chunks_mut(64));
    for (word, (cells, positives)) in words.enumerate() {
        let known = block.load_word(state.knowledge, row, word);
        let confirmed = state.confirmed[word];
        let (mut unknown, mut found, mut any) = ([0; W], [0; W], 0);
        for lane in 0..W {
            unknown[lane] =
                !(known[lane] & confirmed) & bits::valid_mask(0, cells.len()) & flies[lane];
            wanting[lane] |= if unknown[lane] == 0 { 0 } else { u64::MAX };
            any |= unknown[lane];
        }
        let parts = cells.chunks(DRAWS).zip(positives.chunks_mut(DRAWS));
        for (part, (cells, positives)) in parts.enumerate() {
            let first = part * DRAWS;
            if any >> first & 0xF == 0 {
                continue;
            }
            let index = (word * 16 + part) as u32;
            let draws = rng::blocks(seed, t, &uavs, index, Purpose::Detect);
            for (draw, (&cell, positives)) in cells.iter().zip(positives).enumerate() {
                let tabulated = model.detection_table().gather(&rows, Cell::from_word(cell));
                let (draws, bit) = (&draws[draw % DRAWS], first + draw);
                let parts = (&tabulated, &factors);
                *positives += hits(curve, draws, parts, &unknown, bit, &mut found);
            }
        }
        block.store_word(&found, state.detected, row, word);
    }
    block.put_bits(lanes::gather_bits(&wanting), state.sensing);
}

/// The curve's factor of each UAV.
#[inline(always)]
fn factors<const W: usize>(curve: &impl Curve, pilot: &Lanes<u64, W>) -> Lanes<f64, W> {
    let mut factors = [0.0; W];
    for lane in 0..W {
        factors[lane] = curve.factor(f64::from_bits(pilot[lane]));
    }
    factors
}

/// Marks the UAVs that detect hotspot `bit` of the word, and counts them.
#[inline(always)]
fn hits<const W: usize>(
    curve: &impl Curve,
    draws: &Lanes<u32, W>,
    parts: (&Lanes<f64, W>, &Lanes<f64, W>),
    unknown: &Lanes<u64, W>,
    bit: usize,
    found: &mut Lanes<u64, W>,
) -> u64 {
    let (tabulated, factors) = parts;
    let mut count = 0;
    for lane in 0..W {
        let detects = curve.detects(draws[lane], tabulated[lane], factors[lane]);
        let hit = unknown[lane] >> bit & u64::from(detects);
        found[lane] |= hit << bit;
        count += hit;
    }
    count
}

#[inline(always)]
fn confirm(model: &Model<'_>, state: &mut StateMut<'_>, positives: &[u64]) {
    let (t, quorum) = (state.header.t(), u64::from(model.config().quorum));
    for j in 0..model.hotspot_count() {
        if confirms(bits::get(state.confirmed, j), positives[j], quorum) {
            bits::set(state.confirmed, j);
            state.confirmed_at[j] = u64::from(t);
        }
    }
}

/// Whether this step confirms a hotspot: it was not confirmed before, and at least θ UAVs detect
/// it.
#[inline]
#[must_use]
pub const fn confirms(confirmed: bool, positives: u64, quorum: u64) -> bool {
    !confirmed && positives >= quorum
}

/// Sets k_ij to 1 if UAV i detected hotspot j and j is confirmed.
#[inline(always)]
pub fn learn(knowledge: &mut [u64], detected: &[u64], confirmed: &[u64]) {
    if let [confirmed] = confirmed {
        for (known, found) in knowledge.iter_mut().zip(detected) {
            *known |= found & confirmed;
        }
        return;
    }
    let row = confirmed.len();
    let rows = knowledge
        .chunks_exact_mut(row)
        .zip(detected.chunks_exact(row));
    for (known, found) in rows {
        for word in 0..row {
            known[word] |= found[word] & confirmed[word];
        }
    }
}
