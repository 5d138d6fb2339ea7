//! The start of an episode.

use crate::config::{Cell, StartCells};
use crate::error::Error;
use crate::model::Model;
use crate::rules::{graph, potential};
use crate::state::StateMut;
use crate::state::header::Phase;
use crate::state::scratch::Scratch;
use crate::words::bits;
use crate::words::rng::{self, Purpose};
use crate::words::units::round_half_up;

impl Model<'_> {
    /// Begins an episode in `words`; their earlier content is overwritten.
    ///
    /// All random draws of the episode follow from `seed`, which may be any 64-bit number.
    ///
    /// # Errors
    /// [`Error::Length`] unless `words` has [`Model::state_words`] elements.
    pub fn reset(
        &self,
        words: &mut [u64],
        scratch: &mut Scratch<'_>,
        seed: u64,
    ) -> Result<(), Error> {
        self.check_len(words.len())?;
        words.fill(0);
        let mut state = StateMut::split(*self.layout(), words);
        state.header.set_config_hash(self.config_hash());
        state.header.set_seed(seed);
        state
            .header
            .set_intensity(self.carbon().intensity_mg_per_kwh(seed, 0));
        place_hotspots(self, &mut state, scratch, seed);
        for i in 0..self.uav_count() {
            let cell = start_cell(self, seed, i);
            state.cells[i] = cell.to_word();
            state.previous[i] = cell.to_word();
            bits::set(state.visited, self.cell_index(cell));
            let charge_uj = initial_charge_uj(self, seed, i);
            state.battery[i] = charge_uj;
            state.initial[i] = charge_uj;
            bits::assign(state.grounded, i, charge_uj == 0);
            state.set_pilot_density(i, self.config().pilot_density_min);
        }
        graph::build_graph(self, &mut state, scratch);
        potential::update(self, &mut state, scratch, false);
        state.header.set_phase(Phase::Ready);
        Ok(())
    }
}

/// The cell in which a UAV starts: the first depot, or any cell of the grid with equal probability.
// Proof: proofs/reset.rs, a_drawn_start_is_on_the_grid
pub(crate) fn start_cell(model: &Model<'_>, seed: u64, uav: usize) -> Cell {
    match model.config().start_cells {
        StartCells::Depot => model.depots()[0],
        StartCells::Random => {
            let draw = rng::bits64(seed, 0, uav as u32, 0, Purpose::StartCell);
            let index = rng::below(draw, model.config().cell_count() as u64) as u32;
            let width = model.config().grid_width;
            Cell {
                x: index % width,
                y: index / width,
            }
        }
    }
}

/// A UAV's initial charge in microjoules: a uniformly drawn fraction of the capacity.
pub(crate) fn initial_charge_uj(model: &Model<'_>, seed: u64, uav: usize) -> u64 {
    let config = model.config();
    let draw = rng::unit(rng::bits64(seed, 0, uav as u32, 0, Purpose::InitialSoc));
    let soc = config.initial_soc_min + (config.initial_soc_max - config.initial_soc_min) * draw;
    let capacity_uj = model.energy().capacity_uj;
    let charge_uj = round_half_up(soc * capacity_uj as f64);
    if charge_uj > capacity_uj {
        capacity_uj
    } else {
        charge_uj
    }
}

/// Draws distinct cells without a depot. Floyd's sampling makes every set equally likely in n draws
/// (R. Floyd, J. Bentley, CACM 30(9), 1987); a Fisher-Yates shuffle makes every order equally
/// likely.
// Proof: proofs/reset.rs, hotspots_lie_apart
pub(crate) fn place_hotspots(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
    seed: u64,
) {
    let taken = scratch.cells(model);
    taken.fill(0);
    let count = model.hotspot_count();
    let free = model.config().cell_count() - model.depots().len();
    for pick in 0..count {
        let top = free - count + pick;
        let draw = rng::bits64(seed, 0, 0, pick as u32, Purpose::Hotspot);
        let rank = rng::below(draw, top as u64 + 1) as usize;
        let cell = free_cell(model, rank);
        let chosen = if bits::get(taken, model.cell_index(cell)) {
            free_cell(model, top)
        } else {
            cell
        };
        bits::set(taken, model.cell_index(chosen));
        state.hotspots[pick] = chosen.to_word();
    }
    for last in (1..count).rev() {
        let draw = rng::bits64(seed, 0, 0, last as u32, Purpose::Shuffle);
        let other = rng::below(draw, last as u64 + 1) as usize;
        state.hotspots.swap(last, other);
    }
}

/// The cell with a rank among the cells without a depot, in row-major order.
fn free_cell(model: &Model<'_>, rank: usize) -> Cell {
    let mut index = rank;
    // Each depot at or before the cell shifts it by one; one pass suffices in ascending order.
    for depot in model.sorted_depots() {
        if *depot as usize <= index {
            index += 1;
        }
    }
    let width = model.config().grid_width as usize;
    Cell {
        x: (index % width) as u32,
        y: (index / width) as u32,
    }
}
