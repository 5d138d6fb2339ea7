//! The neighbours of every UAV, nearest first, in small fleets.

use crate::lanes::{Block, Cells, Lanes, WIDTH, in_memory};
use crate::model::Model;
use crate::state::StateRef;

/// Bits of a UAV's index in a key; the squared distance takes the bits above.
const INDEX_BITS: u32 = WIDTH.trailing_zeros();
/// Where no neighbour is: above every key, and with an index that no UAV has.
const NONE: i16 = i16::MAX;

/// Most UAVs.
const UAVS: usize = WIDTH - 1;
/// Longest squared distance whose key is below [`NONE`].
const SQUARED_MAX: u32 = (NONE as u32 >> INDEX_BITS) - 1;

/// K. E. Batcher's odd-even merge sort of sixteen keys (AFIPS 1968): the same exchanges whatever the keys, so that
/// all UAVs sort at once.
const EXCHANGES: [(usize, usize); 63] = exchanges();

const fn exchanges() -> [(usize, usize); 63] {
    let mut pairs = [(0, 0); 63];
    let (mut count, mut p) = (0, 1);
    while p < WIDTH {
        let mut k = p;
        while k >= 1 {
            let mut j = k % p;
            while j + k < WIDTH {
                let mut i = 0;
                while i < k && i + j + k < WIDTH {
                    if (i + j) / (2 * p) == (i + j + k) / (2 * p) {
                        pairs[count] = (i + j, i + j + k);
                        count += 1;
                    }
                    i += 1;
                }
                j += 2 * k;
            }
            k /= 2;
        }
        p *= 2;
    }
    pairs
}

/// Whether an index is a UAV's.
static PRESENT: Lanes<f32> = {
    let mut present = [1.0; WIDTH];
    present[UAVS] = 0.0;
    present
};

/// For each UAV its neighbours by distance, ties to the lower index.
pub(crate) struct Ranking {
    /// Slot by slot a key for each UAV.
    keys: [Lanes<i16>; WIDTH],
    cells: Cells,
}

impl Ranking {
    /// None where the fleet or the grid is too large for keys of sixteen bits, or the fleet so small that it does not
    /// pay.
    #[inline(always)]
    pub(crate) fn of(model: &Model<'_>, state: &StateRef<'_>) -> Option<Self> {
        let uavs = model.uav_count();
        let (dx, dy) = (
            model.config().grid_width - 1,
            model.config().grid_height - 1,
        );
        if uavs < super::FLEET || uavs > UAVS || dx * dx + dy * dy > SQUARED_MAX {
            return None;
        }
        let block = Block {
            first: 0,
            count: uavs,
        };
        let cells = Cells::load(block, state.cells);
        let (mut x, mut y, mut own) = ([0i16; WIDTH], [0i16; WIDTH], [0i16; WIDTH]);
        for lane in 0..WIDTH {
            x[lane] = cells.x[lane] as i16;
            y[lane] = cells.y[lane] as i16;
            own[lane] = 1 << lane;
        }
        in_memory(&mut x);
        in_memory(&mut y);
        let mut keys = [[NONE; WIDTH]; WIDTH];
        for k in 0..uavs {
            // The graph is symmetric: the neighbours of k are those that have k as a neighbour.
            let linked = state.links[k] as i16;
            let (kx, ky) = (x[k], y[k]);
            let row = &mut keys[k];
            for lane in 0..WIDTH {
                let (dx, dy) = (x[lane] - kx, y[lane] - ky);
                let key = (dx * dx + dy * dy) << INDEX_BITS | k as i16;
                row[lane] = if linked & own[lane] != 0 { key } else { NONE };
            }
            in_memory(row);
        }
        for (a, b) in EXCHANGES {
            let (low, high) = (keys[a], keys[b]);
            for lane in 0..WIDTH {
                let ordered = low[lane] < high[lane];
                keys[a][lane] = if ordered { low[lane] } else { high[lane] };
                keys[b][lane] = if ordered { high[lane] } else { low[lane] };
            }
        }
        Some(Self { keys, cells })
    }

    /// Writes (present, Δx/(W-1), Δy/(H-1)) for each slot of UAV i.
    #[inline(always)]
    pub(crate) fn write(&self, i: usize, spans: (f32, f32), slots: &mut [f32]) {
        let (x, y) = (self.cells.x[i], self.cells.y[i]);
        let mut offsets = [[0.0; 2]; WIDTH];
        for lane in 0..WIDTH {
            offsets[lane] = [
                (self.cells.x[lane] - x) as f32 / spans.0,
                (self.cells.y[lane] - y) as f32 / spans.1,
            ];
        }
        offsets[UAVS] = [0.0; 2];
        in_memory(&mut offsets);
        for (slot, keys) in slots.chunks_exact_mut(3).zip(&self.keys) {
            let index = keys[i] as usize % WIDTH;
            slot[0] = PRESENT[index];
            slot[1..].copy_from_slice(&offsets[index]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exchanges_sort() {
        // A network that sorts every sequence of zeros and ones sorts every sequence.
        for ones in 0..1u32 << WIDTH {
            let mut keys = ones;
            for (a, b) in EXCHANGES {
                assert!(a < b);
                if keys >> a & 1 > keys >> b & 1 {
                    keys ^= 1 << a | 1 << b;
                }
            }
            let count = ones.count_ones();
            assert_eq!(keys, (0xFFFF << (16 - count)) & 0xFFFF, "{ones:016b}");
        }
    }

    #[test]
    fn keys_stay_below_none() {
        let largest = SQUARED_MAX << INDEX_BITS | (UAVS as u32 - 1);
        assert!(largest < NONE as u32);
        assert_eq!(NONE as usize % WIDTH, UAVS, "an index that no UAV has");
    }
}
