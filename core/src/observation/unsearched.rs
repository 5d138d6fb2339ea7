//! The fractions of a search map that are unsearched, by direction.

use crate::config::Cell;
use crate::constants::observation::DIRECTIONS;
use crate::words::bits;

/// Writes the unsearched fraction of the cells in each direction from `cell`.
///
/// The order is right, up-right, up, and so on counterclockwise. A cell lies up if |Δx| < |Δy|/2,
/// right if |Δy| < |Δx|/2, and up-right between. A direction without cells has a fraction of 0.
pub(crate) fn unsearched_shares(map: &[u64], cell: Cell, width: u32, height: u32, out: &mut [f32]) {
    let (mut cells, mut searched) = ([0usize; DIRECTIONS], [0usize; DIRECTIONS]);
    for y in 0..height {
        let away = y.abs_diff(cell.y);
        // In this row, |Δx| below `straight` means up or down, and |Δx| above 2 `away` right or
        // left.
        let straight = if away == 0 { 1 } else { away.div_ceil(2) };
        let diagonal = 2 * away + 1;
        let row = (y * width) as usize;
        let sides = if y > cell.y { [3, 2, 1] } else { [5, 6, 7] };
        let bounds = [
            0,
            (cell.x + 1).saturating_sub(diagonal),
            (cell.x + 1).saturating_sub(straight),
            cell.x + straight,
            cell.x + diagonal,
            width,
        ];
        let directions = [4, sides[0], sides[1], sides[2], 0];
        for part in 0..directions.len() {
            let begin = at_most(bounds[part], width) as usize;
            let end = at_most(bounds[part + 1], width) as usize;
            // The UAV's own cell lies in no direction.
            let own = away == 0 && part == 2;
            if begin < end && !own {
                cells[directions[part]] += end - begin;
                searched[directions[part]] += bits::count_range(map, row + begin, row + end);
            }
        }
    }
    for direction in 0..DIRECTIONS {
        out[direction] = if cells[direction] == 0 {
            0.0
        } else {
            ((cells[direction] - searched[direction]) as f64 / cells[direction] as f64) as f32
        };
    }
}

fn at_most(value: u32, bound: u32) -> u32 {
    if value < bound { value } else { bound }
}
