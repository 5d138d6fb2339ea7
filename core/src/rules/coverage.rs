//! Coverage: cells that the fleet visits for the first time, and moves into cells visited before.

use crate::lanes::{self, Cells, at_width, ones};
use crate::model::Model;
use crate::state::StateMut;
use crate::state::scratch::{StepTotals, UavStepScratch};
use crate::words::bits;

/// Counts new cells and revisits, of each UAV and of the fleet, and marks the cells as visited.
#[inline(always)]
pub(crate) fn update(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    per_uav: &mut UavStepScratch<'_>,
    totals: &mut StepTotals,
) {
    totals.revisits = at_width!(model, revisit_in_blocks(model, state, per_uav));
    // One after the other: of UAVs in the same new cell, the first discovers it.
    for (new_cell, &index) in per_uav.new_cells.iter_mut().zip(&*per_uav.cell_indices) {
        let (word, bit) = (&mut state.visited[index as usize / 64], index % 64);
        *new_cell = !*word >> bit & 1;
        *word |= 1 << bit;
        totals.new_cells += *new_cell;
    }
}

/// Finds the index of each UAV's cell, and whether the UAV moved into one visited before this step.
#[inline(always)]
fn revisit_in_blocks<const W: usize>(
    model: &Model<'_>,
    state: &StateMut<'_>,
    per_uav: &mut UavStepScratch<'_>,
) -> u64 {
    let mut sum = 0;
    for block in lanes::blocks::<W>(model.uav_count()) {
        let (cells, previous) = (block.load(state.cells), block.load(state.previous));
        let index = Cells::of(&cells).index(model.config().grid_width);
        let mut moved = [0; W];
        for lane in 0..W {
            moved[lane] = ones(cells[lane] != previous[lane]);
        }
        block.store(&index.map(u64::from), per_uav.cell_indices);
        lanes::force_vector(&mut moved);
        let revisits = &mut per_uav.revisits[block.first..][..block.count];
        for (lane, revisit) in block.lanes().zip(revisits) {
            let visited = bits::get(state.visited, index[lane] as usize);
            *revisit = u64::from(visited) & moved[lane];
            sum += *revisit;
        }
    }
    sum
}
