//! Rates open hotspots as the first stop of a tour that visits all of them.
//!
//! After its first hotspot, a tour goes on to the nearest hotspot left (the nearest-neighbour rule:
//! D. J. Rosenkrantz, R. E. Stearns and P. M. Lewis, "An analysis of several heuristics for the
//! traveling salesman problem", 1977). Comparing the first hotspots by the lengths of their tours
//! makes that rule much better (a rollout: D. P. Bertsekas, J. N. Tsitsiklis and C. Wu, "Rollout
//! algorithms for combinatorial optimization", 1997).

use super::layout::HOTSPOT_FIELDS;

/// The maximum number of hotspots of a tour after the first, which bounds its work.
pub const STOPS: usize = 16;

/// The excess over the shortest tour, in cells, from which the rating is 0.
pub const REACH: u32 = 5;

/// The excess added to all tours but the best, in cells. Without it, a fleet between two equal
/// ratings would waver.
pub const MARGIN: u32 = 2;

/// The distance in cells from the differences in an observation. These are whole numbers of cells
/// but for rounding, which must not decide between two equally near hotspots.
fn cells_between(dx: f32, dy: f32, cells: [f32; 2]) -> u32 {
    let cells = dx.abs() * cells[0] + dy.abs() * cells[1];
    (cells + 0.5) as u32
}

/// The hotspot fields of an observation.
#[derive(Clone, Copy)]
struct Hotspots<'a> {
    /// (Δx, Δy, confirmed, known) of each.
    fields: &'a [f32],
    /// Cells that a difference of 1 stands for, along x and y.
    cells: [f32; 2],
}

impl Hotspots<'_> {
    fn place(self, hotspot: usize) -> [f32; 2] {
        let fields = &self.fields[HOTSPOT_FIELDS * hotspot..];
        [fields[0], fields[1]]
    }

    fn is_open(self, hotspot: usize) -> bool {
        self.fields[HOTSPOT_FIELDS * hotspot + 2] == 0.0
    }

    /// Returns the hotspot with the least number among those selected by `left`, and that number.
    /// Ties go to the leftmost hotspot, then to the lowest. All UAVs agree on that, in any cell.
    fn least(
        self,
        left: impl Fn(usize) -> bool,
        number: impl Fn(usize) -> u32,
    ) -> Option<(usize, u32)> {
        let mut least: Option<(usize, u32)> = None;
        for hotspot in (0..self.fields.len() / HOTSPOT_FIELDS).filter(|&hotspot| left(hotspot)) {
            let number = number(hotspot);
            let first = least.is_none_or(|(other, least)| {
                number < least || number == least && self.place(hotspot) < self.place(other)
            });
            if first {
                least = Some((hotspot, number));
            }
        }
        least
    }

    /// Returns the length in cells of the tour that begins with this hotspot. `left` is 1 for each
    /// other hotspot to visit, and 0 for the rest.
    fn tour(self, first: usize, left: &mut [f32]) -> u32 {
        let [mut x, mut y] = self.place(first);
        let mut length = cells_between(x, y, self.cells);
        for _ in 0..STOPS {
            let way = |hotspot| {
                let there = self.place(hotspot);
                cells_between(there[0] - x, there[1] - y, self.cells)
            };
            let Some((next, way)) = self.least(|hotspot| left[hotspot] != 0.0, way) else {
                break;
            };
            left[next] = 0.0;
            length += way;
            [x, y] = self.place(next);
        }
        length
    }
}

/// Rates the hotspots of an observation, given as (Δx, Δy, confirmed, known), with one number each
/// in `out`.
///
/// The first hotspot of the shortest tour is rated 1. Each cell of excess of another tour, with
/// [`MARGIN`], lowers the rating by 1/[`REACH`], down to 0. Confirmed hotspots are rated 0. `cells`
/// holds the cells that a difference of 1 stands for, along x and y. `left` is working memory of
/// the length of `out`.
pub fn rate(hotspots: &[f32], cells: [f32; 2], out: &mut [f32], left: &mut [f32]) {
    let hotspots = Hotspots {
        fields: hotspots,
        cells,
    };
    let is_open = |hotspot| hotspots.is_open(hotspot);
    for first in (0..out.len()).filter(|&first| is_open(first)) {
        for (hotspot, left) in left.iter_mut().enumerate() {
            *left = f32::from(u8::from(hotspot != first && is_open(hotspot)));
        }
        out[first] = hotspots.tour(first, left) as f32;
    }
    let best = hotspots.least(is_open, |hotspot| out[hotspot] as u32);
    for (hotspot, out) in out.iter_mut().enumerate() {
        let behind = match best {
            Some((best, _)) if hotspot == best => 0,
            Some((_, length)) if is_open(hotspot) => MARGIN + *out as u32 - length,
            _ => REACH,
        };
        *out = REACH.saturating_sub(behind) as f32 / REACH as f32;
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::vec;
    use std::vec::Vec;

    /// Returns the ratings of hotspots at these cells, on a grid of 12 × 12, seen from the cell (5,
    /// 5).
    fn rated(places: &[(i32, i32)], confirmed: &[usize]) -> Vec<f32> {
        let mut hotspots = Vec::new();
        for (index, &(x, y)) in places.iter().enumerate() {
            let known = f32::from(u8::from(confirmed.contains(&index)));
            hotspots.extend([(x - 5) as f32 / 11.0, (y - 5) as f32 / 11.0, known, known]);
        }
        let (mut out, mut left) = (vec![7.0; places.len()], vec![7.0; places.len()]);
        rate(&hotspots, [11.0, 11.0], &mut out, &mut left);
        out
    }

    // The hotspots lie in a row: one cell to the right, and two and three cells to the left. The
    // tours take 1 + 3 + 1, 2 + 1 + 4 and 3 + 1 + 3 cells.
    #[test]
    fn a_tour_goes_on_to_the_nearest() {
        let row = [(6, 5), (3, 5), (2, 5)];
        assert_eq!(rated(&row, &[]), [1.0, 0.2, 0.2]);
        // Without the middle hotspot the tours take 1 + 4 and 3 + 4 cells.
        assert_eq!(rated(&row, &[1]), [1.0, 0.0, 0.2]);
        assert_eq!(rated(&row, &[0, 1]), [0.0, 0.0, 1.0]);
        assert_eq!(rated(&row, &[0, 1, 2]), [0.0; 3]);
        assert_eq!(rated(&[], &[]), []);
    }

    // One hotspot is two cells to the left, and three begin three cells to the right. The tours
    // take 2 + 5 + 2 and 3 + 2 + 7 cells. With five more at the left end they take 2 + 5 + 10 + 2
    // and 3 + 2 + 7 + 5.
    #[test]
    fn the_nearest_is_not_always_the_best_to_begin_with() {
        let few = [(3, 5), (8, 5), (9, 5), (10, 5)];
        assert_eq!(rated(&few, &[])[..2], [1.0, 0.0]);
        let many = [
            (3, 5),
            (8, 5),
            (9, 5),
            (10, 5),
            (2, 5),
            (1, 5),
            (0, 5),
            (0, 4),
            (0, 3),
        ];
        assert_eq!(rated(&many, &[])[..2], [0.2, 1.0]);
    }

    // Twenty hotspots lie in a row, one cell apart, and a tour visits seventeen. From the first it
    // takes 17 cells. From the second it takes 2 + 1 + 2 + 14, as it goes back for the first. From
    // the third it takes 3 + 2 + 3 + 13.
    #[test]
    fn a_tour_has_an_end() {
        let row: Vec<(i32, i32)> = (6..26).map(|x| (x, 5)).collect();
        assert_eq!(rated(&row, &[])[..4], [1.0, 0.2, 0.0, 0.0]);
    }

    // At a distance of two cells, one is to the left and one to the right, one below and one above.
    #[test]
    fn of_equals_the_one_furthest_to_the_left_and_then_the_lowest() {
        assert_eq!(rated(&[(7, 5), (3, 5)], &[]), [0.6, 1.0]);
        assert_eq!(rated(&[(5, 7), (5, 3)], &[]), [0.6, 1.0]);
        assert_eq!(rated(&[(5, 3), (5, 7)], &[]), [1.0, 0.6]);
    }

    // Differences of an observation are rounded, which must not rank one of two equally near
    // hotspots first.
    #[test]
    fn equally_near_is_equally_near() {
        for (x, y) in (0..144_i32).map(|cell| (cell % 12, cell / 12)) {
            for (there_x, there_y) in [(0, 0), (3, 10), (11, 7)] {
                let [dx, dy] = [there_x - x, there_y - y].map(|cells| cells as f32 / 11.0);
                let far = cells_between(dx, dy, [11.0, 11.0]);
                let known = (there_x - x).abs() + (there_y - y).abs();
                assert_eq!(i64::from(far), i64::from(known));
            }
        }
    }
}
