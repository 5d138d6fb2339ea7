//! False alarms: UAVs that see a hotspot in a cell that holds none, and the quorum that falsely
//! confirms such a cell.
//!
//! The cells of a footprint are independent, so that the number of alarms among them is binomial
//! and their places are a uniform sample. One draw gives the number, and one more each cell. An
//! alarm in a cell with a hotspot is dropped, which leaves the other cells as they were.

use crate::config::Cell;
use crate::lanes::{self, Block, at_width};
use crate::model::Model;
use crate::radio::false_alarms::{ALARMS_MAX, count};
use crate::state::StateMut;
use crate::state::scratch::Scratch;
use crate::words::bits;
use crate::words::rng::{self, Purpose};

/// Distinct ranks below `size`, at most `size` of them. Floyd's sampling makes every set equally
/// likely.
// Proof: proofs/alarms.rs, sampled_ranks_lie_apart
#[must_use]
pub fn sample(seed: u64, t: u32, uav: u32, count: u32, size: u32) -> ([u32; ALARMS_MAX], usize) {
    let (mut ranks, mut taken) = ([0; ALARMS_MAX], 0);
    let count = if count < size { count } else { size };
    while taken < count as usize && taken < ALARMS_MAX {
        let top = size - count + taken as u32;
        let draw = rng::bits64(seed, t, uav, 1 + taken as u32, Purpose::FalseAlarm);
        let rank = rng::below(draw, u64::from(top) + 1) as u32;
        ranks[taken] = if ranks[..taken].contains(&rank) {
            top
        } else {
            rank
        };
        taken += 1;
    }
    (ranks, taken)
}

/// Draws the false alarms of every UAV that sensed, and confirms cells by quorum.
// Proof: proofs/alarms.rs, a_false_confirmation_is_never_taken_back
#[inline(always)]
pub(crate) fn raise(model: &Model<'_>, state: &mut StateMut<'_>, scratch: &mut Scratch<'_>) {
    at_width!(model, raise_in_blocks(model, state));
    if model.layout().remembered_false > 0 {
        confirm_over_episode(model, state);
    } else {
        confirm(model, state, scratch.cell_counts(model));
    }
}

/// Takes back the false alarms of the step before, for a step whose detections a host supplies.
pub(crate) fn silence(state: &mut StateMut<'_>) {
    state.false_alarms.fill(0);
    state.newly_false.fill(0);
}

/// Number of cells that were falsely confirmed in this step.
#[inline(always)]
pub(crate) fn newly_false(state: &StateMut<'_>) -> u64 {
    state.newly_false.first().copied().unwrap_or(0)
}

#[inline(always)]
fn raise_in_blocks<const W: usize>(model: &Model<'_>, state: &mut StateMut<'_>) {
    for block in lanes::blocks::<W>(model.uav_count()) {
        raise_in(model, state, block);
    }
}

/// Draws the false alarms of a block's UAVs. The numbers of alarms are drawn side by side; most of
/// them are 0.
#[inline(always)]
fn raise_in<const W: usize>(model: &Model<'_>, state: &mut StateMut<'_>, block: Block<W>) {
    let (seed, t) = (state.header.seed(), state.header.t());
    let uavs = block.indices().map(|index| block.first as u32 + index);
    let senses = block.bits(state.sensing);
    let [draws, ..] = rng::blocks(seed, t, &uavs, 0, Purpose::FalseAlarm);
    let (sizes, rows) = model.alarm_tables().split_at(model.config().cell_count());
    let first = block.first * ALARMS_MAX;
    let alarms = state.false_alarms[first..].chunks_exact_mut(ALARMS_MAX);
    let cells = state.cells[block.first..].iter();
    for (lane, (alarms, &word)) in block.lanes().zip(alarms.zip(cells)) {
        alarms.fill(0);
        if senses >> lane & 1 == 0 {
            continue;
        }
        let cell = Cell::from_word(word);
        let size = sizes[model.cell_index(cell)] as u32;
        let thresholds = &rows[size as usize * ALARMS_MAX..][..ALARMS_MAX];
        let count = count(draws[lane], thresholds);
        if count > 0 {
            let (ranks, taken) = sample(seed, t, uavs[lane], count, size);
            see(model, state.hotspots, cell, &ranks[..taken], alarms);
        }
    }
}

/// Stores the cells of a footprint with these ranks, except for cells that hold a hotspot.
fn see(model: &Model<'_>, hotspots: &[u64], own: Cell, ranks: &[u32], alarms: &mut [u64]) {
    let (width, height) = (model.config().grid_width, model.config().grid_height);
    let mut raised = 0;
    for &rank in ranks {
        let cell = model.footprint().ranked(rank, own, width, height);
        if !hotspots.contains(&cell.to_word()) {
            alarms[raised] = model.cell_index(cell) as u64 + 1;
            raised += 1;
        }
    }
}

/// Confirms the cells in which at least θ UAVs raised a false alarm.
fn confirm(model: &Model<'_>, state: &mut StateMut<'_>, counts: &mut [u64]) {
    let quorum = u64::from(model.config().quorum);
    let (alarms, confirmed) = (&*state.false_alarms, &mut *state.falsely_confirmed);
    state.newly_false[0] = confirm_cells(alarms, quorum, confirmed, counts);
}

/// Confirms the cells in which at least θ UAVs have raised a false alarm in the episode.
fn confirm_over_episode(model: &Model<'_>, state: &mut StateMut<'_>) {
    let row = model.layout().remembered_false;
    let alarms = state.false_alarms.chunks_exact(model.layout().alarms);
    for (alarms, kept) in alarms.zip(state.remembered_false.chunks_exact_mut(row)) {
        for &alarm in alarms {
            if alarm > 0 {
                bits::set(kept, alarm as usize - 1);
            }
        }
    }
    let quorum = u64::from(model.config().quorum);
    let (kept, confirmed) = (&*state.remembered_false, &mut *state.falsely_confirmed);
    state.newly_false[0] = confirm_kept(state.false_alarms, kept, quorum, confirmed);
}

/// Adds each cell with an alarm that at least `quorum` UAVs keep to a set, and returns how many
/// cells joined it. `kept` has a row of cells for each UAV.
// Proof: proofs/alarms.rs, a_kept_false_alarm_counts_once
#[must_use]
pub fn confirm_kept(alarms: &[u64], kept: &[u64], quorum: u64, confirmed: &mut [u64]) -> u64 {
    let mut fresh = 0;
    for &alarm in alarms {
        if alarm > 0 {
            let cell = alarm as usize - 1;
            let mut seen = 0;
            for row in kept.chunks_exact(confirmed.len()) {
                seen += u64::from(bits::get(row, cell));
            }
            if seen >= quorum && !bits::get(confirmed, cell) {
                bits::set(confirmed, cell);
                fresh += 1;
            }
        }
    }
    fresh
}

/// Adds each cell with at least `quorum` alarms to a set, and returns how many cells joined it.
///
/// An alarm is a row-major index plus 1, or 0 for none. `counts` has a word for each cell and any
/// content; only the words of cells with an alarm are used.
// Proof: proofs/alarms.rs, a_false_confirmation_is_never_taken_back
#[must_use]
pub fn confirm_cells(
    alarms: &[u64],
    quorum: u64,
    confirmed: &mut [u64],
    counts: &mut [u64],
) -> u64 {
    let mut fresh = 0;
    for &alarm in alarms {
        if alarm > 0 {
            counts[alarm as usize - 1] = 0;
        }
    }
    for &alarm in alarms {
        if alarm > 0 {
            let cell = alarm as usize - 1;
            counts[cell] += 1;
            if counts[cell] == quorum && !bits::get(confirmed, cell) {
                bits::set(confirmed, cell);
                fresh += 1;
            }
        }
    }
    fresh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;

    #[test]
    fn without_false_alarms_the_state_and_the_tables_have_no_word_more() {
        let config = Config::default();
        let mut words = std::vec![0; Model::table_words(&config).unwrap()];
        let silent = Model::new_in(config, &mut words).unwrap();
        assert!(silent.alarm_tables().is_empty());
        assert_eq!(silent.layout().alarms + silent.layout().false_cells, 0);
    }
}
