//! The entries of the nearest neighbours in an observation.

use super::View;

/// Bits of a UAV's index in a sorting key; squared distances take the bits above.
const INDEX_BITS: u32 = 12;

impl View<'_> {
    /// Fills the slots with the nearest neighbours; ties go to the lower index.
    #[inline(always)]
    pub(super) fn write_neighbours(&self, i: usize, keys: &mut [u64], out: &mut [f32]) {
        let cell = self.state.cell(i);
        let mut degree = 0;
        for (word, &set) in self.state.links_of(i).iter().enumerate() {
            let mut rest = set;
            while rest != 0 {
                let k = word * 64 + rest.trailing_zeros() as usize;
                rest &= rest - 1;
                let other = self.state.cell(k);
                let (dx, dy) = (cell.x.abs_diff(other.x), cell.y.abs_diff(other.y));
                keys[degree] = u64::from(dx * dx + dy * dy) << INDEX_BITS | k as u64;
                degree += 1;
            }
        }
        let (from, slots) = (self.offsets_from(cell), out.len() / 3);
        let (filled, empty) = out.split_at_mut(3 * degree.min(slots));
        empty.fill(0.0);
        let keys = &mut keys[..degree];
        nearest_first(keys, slots);
        for (row, &key) in filled.chunks_exact_mut(3).zip(&*keys) {
            let other = self.state.cell((key & ((1 << INDEX_BITS) - 1)) as usize);
            let (dx, dy) = from.to(other);
            row[0] = 1.0;
            row[1] = dx;
            row[2] = dy;
        }
    }
}

/// Largest number of keys for which insertion sort is used. It is faster than a general sort there,
/// because neighbours in one cell are already in order.
const FEW: usize = 24;

/// Moves the smallest `count` keys to the front, in ascending order.
#[inline(always)]
fn nearest_first(keys: &mut [u64], count: usize) {
    if keys.len() <= FEW {
        for end in 1..keys.len() {
            let key = keys[end];
            let mut slot = end;
            while slot > 0 && keys[slot - 1] > key {
                keys[slot] = keys[slot - 1];
                slot -= 1;
            }
            keys[slot] = key;
        }
        return;
    }
    if count < keys.len() {
        keys.select_nth_unstable(count);
    }
    let nearest = count.min(keys.len());
    keys[..nearest].sort_unstable();
}
