//! P10, the base case: a reset makes a valid state from any memory and any seed. Hotspots lie in
//! different cells, and a drawn charge fits its battery.

#[cfg(not(kani))]
use super::standin as kani;
use super::state::{STATE_WORDS, view};
use crate::config::Cell;
use crate::rules::reset::{initial_charge_uj, place_hotspots, start_cell};
use crate::state::StateMut;
use crate::state::header::Phase;
use crate::state::scratch::Scratch;

/// The base case holds for any memory and any seed.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(64))]
#[cfg_attr(
    kani,
    kani::stub(crate::words::rng::block, crate::proofs::stubs::any_block)
)]
#[cfg_attr(
    kani,
    kani::stub(
        crate::rules::reset::initial_charge_uj,
        crate::proofs::stubs::any_charge
    )
)]
#[cfg_attr(
    kani,
    kani::stub(crate::rules::graph::build_graph, crate::proofs::stubs::any_graph)
)]
#[cfg_attr(
    kani,
    kani::stub(crate::rules::potential::update, crate::proofs::stubs::any_potentials)
)]
pub fn reset_makes_a_valid_state() {
    given!(model = any_charged_model);
    let mut words: [u64; STATE_WORDS] = kani::any();
    given!(scratch for model);
    let done = model.reset(&mut words[..model.state_words()], &mut scratch, kani::any());
    assert!(done.is_ok());
    let state = view(&model, &words);
    kani::cover!(
        state.hotspot_cell(0).x == 0,
        "a hotspot in the first column"
    );
    kani::cover!(state.battery_uj(0) > 0, "a charged battery");
    kani::cover!(state.grounded(0), "an empty battery");
    assert!(state.t() == 0 && state.header.phase() == Some(Phase::Ready));
    assert!(state.is_valid(&model));
}

/// Words of a state with two hotspots; of any state that the stand-in makes.
#[cfg(kani)]
const SPREAD_WORDS: usize = super::state::SMALLEST_SPREAD_WORDS;
/// Words of a state with two hotspots; of any state that the stand-in makes.
#[cfg(not(kani))]
const SPREAD_WORDS: usize = STATE_WORDS;

#[cfg(kani)]
const SPREAD_SCRATCH_WORDS: usize = super::state::SMALLEST_SPREAD_SCRATCH_WORDS;
#[cfg(not(kani))]
const SPREAD_SCRATCH_WORDS: usize = super::state::SCRATCH_WORDS;

/// For any draws, hotspots lie in different cells of the grid without a depot.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
#[cfg_attr(
    kani,
    kani::stub(crate::words::rng::block, crate::proofs::stubs::any_block)
)]
pub fn hotspots_lie_apart() {
    given!(model = any_spread_model);
    let mut words = [0; SPREAD_WORDS];
    let mut state = StateMut::split(*model.layout(), &mut words[..model.state_words()]);
    let mut scratch: [u64; SPREAD_SCRATCH_WORDS] = kani::any();
    let mut scratch = Scratch::new(&model, &mut scratch).ok().unwrap();
    place_hotspots(&model, &mut state, &mut scratch, kani::any());
    let first = state.hotspot_cell(0);
    kani::cover!(first.x == 0 && first.y == 0, "the first free cell");
    kani::cover!(first.x == 0 && first.y == 1, "the last free cell of a row");
    for j in 0..model.hotspot_count() {
        let cell = state.hotspot_cell(j);
        assert!(model.contains(cell) && model.depot_distance(cell) != 0);
        for k in 0..j {
            let other = state.hotspot_cell(k);
            assert!(cell.x != other.x || cell.y != other.y);
        }
    }
}

/// For any draw and any range of charges, a battery holds at most its capacity.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(
    kani,
    kani::stub(crate::words::rng::block, crate::proofs::stubs::any_block)
)]
pub fn a_drawn_charge_fits_the_battery() {
    given!(model = any_charged_model);
    let charge_uj = initial_charge_uj(&model, kani::any(), 0);
    kani::cover!(charge_uj == 0, "empty");
    kani::cover!(charge_uj == model.energy().capacity_uj, "full");
    assert!(charge_uj <= model.energy().capacity_uj);
}

/// For any draw, a UAV that starts anywhere starts on the grid.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(
    kani,
    kani::stub(crate::words::rng::block, crate::proofs::stubs::any_block)
)]
pub fn a_drawn_start_is_on_the_grid() {
    given!(model = any_scattered_model);
    let cell = start_cell(&model, kani::any(), 0);
    kani::cover!(cell == Cell { x: 0, y: 0 }, "the first cell");
    kani::cover!(model.depot_distance(cell) == 0, "a depot");
    assert!(model.contains(cell));
}

#[cfg(not(kani))]
super::standin::twins! {
    reset_makes_a_valid_state: 2000 cases, 3 covers;
    hotspots_lie_apart: 2000 cases, 2 covers;
    a_drawn_charge_fits_the_battery: 2000 cases, 2 covers;
    a_drawn_start_is_on_the_grid: 2000 cases, 2 covers;
}
