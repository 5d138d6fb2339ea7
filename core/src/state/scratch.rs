//! Working memory of a step. Its content is lost after a call, so that one per thread serves any
//! number of states.

use crate::error::Error;
use crate::lanes::{self, Lanes};
use crate::model::Model;
use crate::words::bits;

/// Largest fleet for which checking every pair is faster than sorting the UAVs into buckets.
const FEW: usize = 48;

/// Number of UAVs with which a block is compared at a time. The table is read for all of them
/// before the first comparison.
pub(crate) const fn tile(width: usize) -> usize {
    if width == 1 { lanes::WIDE } else { width }
}

/// Whether a fleet's links are found pair by pair. Each of its sets of UAVs is then one word.
pub(crate) const fn by_pairs(uavs: usize) -> bool {
    uavs <= FEW
}

/// Working memory for steps of the states of one model.
#[derive(Debug)]
pub struct Scratch<'a> {
    words: &'a mut [u64],
}

impl<'a> Scratch<'a> {
    /// Number of `u64` words that a model's steps need.
    #[must_use]
    pub fn words_for(model: &Model<'_>) -> usize {
        let uavs = model.uav_count();
        let (hotspots, cells) = (model.hotspot_count(), model.config().cell_count());
        let graph = model.bucket_count() + 1 + uavs;
        let longest = model.hotspot_words().max(model.map_words());
        let longest = longest.max(model.layout().reports);
        let consensus = uavs + model.uav_words() + longest;
        let ending = UavStepScratch::WORDS * uavs + hotspots;
        let width = lanes::width_of(uavs);
        let pairs = if by_pairs(uavs) {
            uavs + tile(width) * width
        } else {
            0
        };
        let alarms = if model.layout().alarms > 0 {
            cells
        } else {
            bits::words_for(cells)
        };
        alarms.max(graph).max(consensus).max(ending).max(pairs)
    }

    /// Uses the caller's memory; its content does not matter.
    ///
    /// # Errors
    /// [`Error::ScratchTooSmall`] if it has fewer than [`Scratch::words_for`] words.
    pub fn new(model: &Model<'_>, words: &'a mut [u64]) -> Result<Self, Error> {
        let words_min = Self::words_for(model);
        if words.len() < words_min {
            return Err(Error::ScratchTooSmall {
                words_min,
                words: words.len(),
            });
        }
        Ok(Self { words })
    }

    /// A set of cells.
    pub(crate) fn cells(&mut self, model: &Model<'_>) -> &mut [u64] {
        self.list(bits::words_for(model.config().cell_count()))
    }

    /// A word for each cell.
    pub(crate) fn cell_counts(&mut self, model: &Model<'_>) -> &mut [u64] {
        self.list(model.config().cell_count())
    }

    /// Bucket boundaries and the UAVs sorted by bucket.
    pub(crate) fn buckets(&mut self, model: &Model<'_>) -> (&mut [u64], &mut [u64]) {
        let (starts, rest) = self.words.split_at_mut(model.bucket_count() + 1);
        (starts, &mut rest[..model.uav_count()])
    }

    /// A word for each UAV, and one for each pair of a lane and a UAV of the current tile.
    pub(crate) fn pairs<const W: usize>(
        &mut self,
        uavs: usize,
    ) -> (&mut [u64], &mut [Lanes<u64, W>]) {
        let (sums, rest) = self.words.split_at_mut(uavs);
        (sums, rest[..tile(W) * W].as_chunks_mut().0)
    }

    /// The order of a graph traversal, the set of UAVs not yet reached, and the union of rows of a
    /// connected component.
    pub(crate) fn consensus(
        &mut self,
        uavs: usize,
        uav_words: usize,
        row_words: usize,
    ) -> (&mut [u64], &mut [u64], &mut [u64]) {
        let (order, rest) = self.words.split_at_mut(uavs);
        let (unreached, rest) = rest.split_at_mut(uav_words);
        (order, unreached, &mut rest[..row_words])
    }

    /// The per-UAV quantities of the step, and the remaining memory.
    pub(crate) fn per_uav(&mut self, uavs: usize) -> (UavStepScratch<'_>, Scratch<'_>) {
        let (spent_uj, rest) = self.words.split_at_mut(uavs);
        let (billed_uj, rest) = rest.split_at_mut(uavs);
        let (cell_indices, rest) = rest.split_at_mut(uavs);
        let (new_cells, rest) = rest.split_at_mut(uavs);
        let (revisits, rest) = rest.split_at_mut(uavs);
        let (goal_before, rest) = rest.split_at_mut(uavs);
        let (charge_before, words) = rest.split_at_mut(uavs);
        let per_uav = UavStepScratch {
            spent_uj,
            billed_uj,
            cell_indices,
            new_cells,
            revisits,
            goal_before,
            charge_before,
        };
        (per_uav, Scratch { words })
    }

    /// Room for a list of at most `count` words.
    pub(crate) fn list(&mut self, count: usize) -> &mut [u64] {
        &mut self.words[..count]
    }
}

/// Per-UAV quantities of a step, from which each UAV's own reward follows. Every slice has N words.
pub(crate) struct UavStepScratch<'a> {
    /// Energy spent, in microjoules.
    pub(crate) spent_uj: &'a mut [u64],
    /// Charging energy billed, in microjoules.
    pub(crate) billed_uj: &'a mut [u64],
    /// Row-major index of the UAV's cell.
    pub(crate) cell_indices: &'a mut [u64],
    /// 1 if the UAV was the first in a cell that no UAV had visited; else 0.
    pub(crate) new_cells: &'a mut [u64],
    /// 1 if the UAV moved into a cell visited before; else 0.
    pub(crate) revisits: &'a mut [u64],
    /// Φ of the distance to hotspots before the step, as bits of f64.
    pub(crate) goal_before: &'a mut [u64],
    /// Φ of carbon-aware charging before the step, as bits of f64.
    pub(crate) charge_before: &'a mut [u64],
}

impl UavStepScratch<'_> {
    /// Words per UAV.
    const WORDS: usize = 7;
}

/// Totals of a step over the fleet, from which the team's reward follows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepTotals {
    /// Number of hotspots confirmed in this step.
    pub newly_confirmed: u64,
    /// Number of cells falsely confirmed in this step.
    pub newly_false: u64,
    /// Number of hotspots informed in this step.
    pub newly_informed: u64,
    /// Number of hotspots informed in this step or before.
    pub informed: u64,
    /// Number of hotspots confirmed in this step or before.
    pub confirmed: u64,
    /// True if every hotspot is confirmed and informed.
    pub complete: bool,
    /// True if this is the last step of the horizon, T_max.
    pub at_horizon: bool,
    /// Number of cells visited for the first time.
    pub new_cells: u64,
    /// Number of UAVs that moved into a cell visited before this step.
    pub revisits: u64,
    /// Energy spent by the fleet, in microjoules.
    pub spent_uj: u64,
    /// Carbon emitted by the fleet, in nanograms.
    pub co2_ng: f64,
    /// Mean normalised throughput over the fleet, η̄(t).
    pub mean_throughput: f64,
    /// Mean over confirmed hotspots of the fraction of UAVs that know them.
    pub knowledge_spread: f64,
    /// Fleet mean of the goal potential before the step.
    pub goal_potential_before: f64,
    /// Fleet mean of the goal potential after the step; 0 in a terminal state.
    pub goal_potential_after: f64,
    /// Fleet mean of the charging potential before the step.
    pub charge_potential_before: f64,
    /// Fleet mean of the charging potential after the step; 0 in a terminal state.
    pub charge_potential_after: f64,
}

#[cfg(test)]
mod tests {
    use std::string::ToString;
    use std::{format, vec};

    use super::*;
    use crate::config::Config;

    #[test]
    fn memory_that_lacks_a_word_is_refused_as_too_small() {
        let config = Config::default();
        let mut tables = vec![0; Model::table_words(&config).unwrap()];
        let model = Model::new_in(config, &mut tables).unwrap();
        let words_min = Scratch::words_for(&model);
        let mut memory = vec![0; words_min];
        assert!(Scratch::new(&model, &mut memory).is_ok());
        let words = words_min - 1;
        let refused = Scratch::new(&model, &mut memory[..words]).unwrap_err();
        assert_eq!(refused, Error::ScratchTooSmall { words_min, words });
        let message = format!("the scratch has {words} words: must have at least {words_min}");
        assert_eq!(refused.to_string(), message);
    }
}
