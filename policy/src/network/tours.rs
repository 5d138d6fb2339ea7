//! Which hotspot to begin with, where all open ones are to be seen in one tour.
//!
//! A tour goes on to the nearest of those that are left (the rule of the nearest neighbour: D. J. Rosenkrantz, R. E.
//! Stearns and P. M. Lewis, "An analysis of several heuristics for the traveling salesman problem", 1977), whatever it
//! began with. Comparing the beginnings by the tours that follow makes that rule a good deal better (a rollout: D. P.
//! Bertsekas, J. N. Tsitsiklis and C. Wu, "Rollout algorithms for combinatorial optimization", 1997).

use super::plan::HOTSPOT_FIELDS;

/// Most hotspots of a tour after the first: a bound on its work.
pub const STOPS: usize = 16;

/// From how many cells longer than the shortest on a tour is worth nothing.
pub const REACH: u32 = 5;

/// How many cells longer the tours of all but one count: a fleet between two that were rated alike would waver.
pub const MARGIN: u32 = 2;

/// Cells between two hotspots, or to one, by their differences in an observation. Those are whole numbers of cells
/// but for rounding, which is not to decide between two equally near.
fn cells_between(dx: f32, dy: f32, cells: [f32; 2]) -> u32 {
    let cells = dx.abs() * cells[0] + dy.abs() * cells[1];
    (cells + 0.5) as u32
}

/// The hotspots of an observation.
#[derive(Clone, Copy)]
struct Hotspots<'a> {
    /// (Δx, Δy, confirmed, known) of each.
    fields: &'a [f32],
    /// Cells that a difference of 1 stands for.
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

    /// Of those that `left` tells, the one with the least number, and that number. Of several it is the one furthest
    /// to the left, and then the lowest: all UAVs agree on that, wherever they are.
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

    /// Cells of the tour that begins with this hotspot. `left` is 1 for each of the others that it has to see, and 0
    /// for those that it has seen, or has no need to.
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

/// Rates the hotspots of an observation (Δx, Δy, confirmed, known), one number each: 1 for the one that the shortest tour
/// begins with, less for the others by one in [`REACH`] for each cell by which theirs count as longer, down to 0; 0 for
/// those that are confirmed. `cells` are those that a difference of 1 stands for; `left` is working memory, as
/// long as `out`.
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

    /// Ratings of hotspots at these cells, on a grid of 12 × 12, seen from the cell (5, 5).
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

    // In a row, one cell to the right and two and three to the left: 1 + 3 + 1 cells, 2 + 1 + 4 and 3 + 1 + 3.
    #[test]
    fn a_tour_goes_on_to_the_nearest() {
        let row = [(6, 5), (3, 5), (2, 5)];
        assert_eq!(rated(&row, &[]), [1.0, 0.2, 0.2]);
        // Without the one between, 1 + 4 and 3 + 4.
        assert_eq!(rated(&row, &[1]), [1.0, 0.0, 0.2]);
        assert_eq!(rated(&row, &[0, 1]), [0.0, 0.0, 1.0]);
        assert_eq!(rated(&row, &[0, 1, 2]), [0.0; 3]);
        assert_eq!(rated(&[], &[]), []);
    }

    // One is two cells to the left, and three begin three cells to the right: 2 + 5 + 2 cells, and 3 + 2 + 7. With five
    // more at the left end, 2 + 5 + 10 + 2, and 3 + 2 + 7 + 5.
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

    // Twenty in a row, one cell apart, and tours of seventeen: 17 cells from the first on; 2 + 1 + 2 + 14 from the second,
    // which goes back for the first; 3 + 2 + 3 + 13 from the third.
    #[test]
    fn a_tour_has_an_end() {
        let row: Vec<(i32, i32)> = (6..26).map(|x| (x, 5)).collect();
        assert_eq!(rated(&row, &[])[..4], [1.0, 0.2, 0.0, 0.0]);
    }

    // Two cells away are one to the left and one to the right, one below and one above.
    #[test]
    fn of_equals_the_one_furthest_to_the_left_and_then_the_lowest() {
        assert_eq!(rated(&[(7, 5), (3, 5)], &[]), [0.6, 1.0]);
        assert_eq!(rated(&[(5, 7), (5, 3)], &[]), [0.6, 1.0]);
        assert_eq!(rated(&[(5, 3), (5, 7)], &[]), [1.0, 0.6]);
    }

    // Differences of an observation are rounded, which must not make one of two nearer that are as near.
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
