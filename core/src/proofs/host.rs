//! P10, a host's calls: what they put in place of the model's own leaves a valid state, and a call that is
//! refused leaves every word as it was.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use super::state::{SCRATCH_WORDS, any_fleet, any_state, carries_scalars, differ, open, view};
use crate::config::Cell;
use crate::header::Phase;
use crate::model::any_model::{TABLE_WORDS, any_model};
use crate::scratch::Scratch;

/// UAVs of the smallest model, and of any that the stand-in makes; no model has more hotspots.
const MOST: usize = if cfg!(kani) { 2 } else { 5 };

/// Cells on the grid of any model here and just beside it.
fn any_cells() -> [Cell; MOST] {
    let mut cells = [Cell { x: 0, y: 0 }; MOST];
    for index in 0..MOST {
        cells[index].x = between(0, if cfg!(kani) { 2 } else { 4 }) as u32;
        cells[index].y = between(0, 2) as u32;
    }
    cells
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
pub fn setting_positions_keeps_the_state_valid() {
    let mut tables = [0; TABLE_WORDS];
    let model = any_model(&mut tables);
    let before = any_fleet(&model, Phase::Moved);
    let mut after = before;
    let cells = any_cells();
    let cells = &cells[..model.uav_count()];
    let done = model.set_positions(&mut open(&model, &mut after), cells);
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(done.is_ok() && old.cell(0) != new.cell(0), "a UAV is moved");
    kani::cover!(done.is_err(), "a cell off the grid");
    if done.is_ok() {
        carries_scalars(&old, &new);
        assert!(new.header.phase() == Some(Phase::Moved));
        assert!(new.fleet_is_valid(&model, Phase::Moved));
    } else {
        assert!(!differ(&before, &after));
    }
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(13))]
#[cfg_attr(
    kani,
    kani::stub(crate::potential::update, crate::proofs::stubs::any_potentials)
)]
pub fn setting_hotspots_keeps_the_state_valid() {
    let mut tables = [0; TABLE_WORDS];
    let model = any_model(&mut tables);
    let before = any_state(&model, Phase::Ready);
    let mut after = before;
    let mut scratch: [u64; SCRATCH_WORDS] = kani::any();
    let mut scratch = Scratch::new(&model, &mut scratch).unwrap();
    let cells = any_cells();
    let cells = &cells[..model.hotspot_count()];
    let done = model.set_hotspots(&mut open(&model, &mut after), &mut scratch, cells);
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(done.is_ok(), "hotspots are set");
    kani::cover!(
        done.is_err() && old.t() == 0,
        "a cell that is none for a hotspot"
    );
    kani::cover!(done.is_err() && old.t() > 0, "after the start");
    if done.is_ok() {
        assert!(new.header.phase() == Some(Phase::Ready));
        assert!(new.is_valid(&model));
    } else {
        assert!(!differ(&before, &after));
    }
}

#[cfg(not(kani))]
super::standin::twins! {
    setting_positions_keeps_the_state_valid: 2000 cases, 2 covers;
    setting_hotspots_keeps_the_state_valid: 2000 cases, 3 covers;
}
