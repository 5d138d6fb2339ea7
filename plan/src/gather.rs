//! The end of an episode: the fleet meets until it is one radio component.

use jcas_core::Cell;

use crate::odds::Odds;

/// The maximum number of UAVs of a plan: a set of them is one integer.
pub(crate) const UAVS_MAX: usize = 128;

/// Returns whether the fleet is one radio component. It takes at most [`UAVS_MAX`] UAVs.
pub(crate) fn connected(odds: &Odds, cells: &[Cell], level: impl Fn(usize) -> u8) -> bool {
    let count = cells.len();
    let mut unmet = if count == UAVS_MAX {
        u128::MAX
    } else {
        (1u128 << count) - 1
    } & !1;
    let mut open = 1u128;
    while open != 0 && unmet != 0 {
        let i = open.trailing_zeros() as usize;
        open &= open - 1;
        let mut rest = unmet;
        while rest != 0 {
            let k = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            if odds.linked((cells[i], level(i)), (cells[k], level(k))) {
                unmet &= !(1 << k);
                open |= 1 << k;
            }
        }
    }
    unmet == 0
}
