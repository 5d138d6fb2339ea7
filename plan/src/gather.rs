//! The end of an episode: the fleet meets until it is one radio component.

use jcas_core::Cell;

use crate::odds::Odds;

/// The maximum number of UAVs of a plan: a set of them is one integer.
pub(crate) const UAVS_MAX: usize = 128;

/// Returns the cell where a fleet meets soonest. It is the centre in Manhattan distance, with the
/// least distance to the farthest UAV.
///
/// With u = x + y and v = x - y, Manhattan distance is the larger of the two differences. The
/// centre is then that of the bounding box. Where it is no cell, the best cell around it is taken.
/// Among equals that is the one with the least total distance, then the first.
#[must_use]
pub fn meeting_cell(cells: impl Iterator<Item = Cell> + Clone, width: u32, height: u32) -> Cell {
    let middle = |of: fn(i64, i64) -> i64| {
        let (mut low, mut high) = (i64::MAX, i64::MIN);
        for cell in cells.clone() {
            let value = of(i64::from(cell.x), i64::from(cell.y));
            low = low.min(value);
            high = high.max(value);
        }
        if low > high {
            0
        } else {
            (low + high).div_euclid(2)
        }
    };
    let (u, v) = (middle(|x, y| x + y), middle(|x, y| x - y));
    let (x, y) = ((u + v).div_euclid(2), (u - v).div_euclid(2));
    let (mut best, mut least) = (Cell::default(), (u32::MAX, u64::MAX));
    for dx in -1..=1 {
        for dy in -1..=1 {
            let centre = Cell {
                x: (x + dx).max(0).min(i64::from(width) - 1) as u32,
                y: (y + dy).max(0).min(i64::from(height) - 1) as u32,
            };
            let (mut most, mut sum) = (0, 0);
            for cell in cells.clone() {
                let distance = cell.manhattan(centre);
                most = most.max(distance);
                sum += u64::from(distance);
            }
            if (most, sum) < least {
                (best, least) = (centre, (most, sum));
            }
        }
    }
    best
}

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
