//! P8 for reports: a sighting raises its cell by one level, and no report is taken back.
//!
//! Reports spread by the consensus of P7, whose rows may have any length.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::rules::reports::raise;
use crate::words::bits::level;

/// Cells of the harness, and the set of all of them.
const CELLS: u64 = 3;
const ALL: u64 = (1 << CELLS) - 1;

/// Any two nested levels above two others.
fn any_levels(least: [u64; 2]) -> [u64; 2] {
    let low = least[0] | between(0, ALL);
    [low, least[1] | (low & between(0, ALL))]
}

/// A sighting adds its cell to the next of a UAV's levels and to the same level of its reports.
/// Levels stay nested, and no other cell changes.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(3))]
pub fn a_sighting_raises_one_cell_by_one_level() {
    let own_before = any_levels([0; 2]);
    let known_before = any_levels(own_before);
    let cell = between(0, CELLS - 1) as usize;
    let (mut own, mut known) = (own_before, known_before);
    raise(&mut own, &mut known, 1, cell);
    let before = level(&own_before, 1, cell);
    kani::cover!(before == 2, "every level has the cell");
    kani::cover!(
        before == 0 && level(&known_before, 1, cell) == 2,
        "heard of before"
    );
    assert!(level(&own, 1, cell) == if before == 2 { 2 } else { before + 1 });
    let others = ALL & !(1 << cell);
    for index in 0..2 {
        assert!(own[index] & others == own_before[index] & others);
        assert!(own[index] & own_before[index] == own_before[index]);
        assert!(known[index] == known_before[index] | own[index]);
    }
    assert!(own[1] & !own[0] == 0 && known[1] & !known[0] == 0);
}

#[cfg(not(kani))]
super::standin::twins! {
    a_sighting_raises_one_cell_by_one_level: 4000 cases, 2 covers;
}
