//! The neighbours of every UAV, nearest first, in small fleets.

use crate::lanes::real::Divisors;
use crate::lanes::{Block, Cells, Lanes, WIDTH, in_memory, repeat};
use crate::model::Model;
use crate::state::StateRef;

/// Bits of a UAV's index in a key; the squared distance takes the bits above.
const INDEX_BITS: u32 = WIDTH.trailing_zeros();
/// Where no neighbour is: above every key, and with an index that no UAV has.
const NONE: i16 = i16::MAX;

/// Reals that place a UAV; the last is written over by the next slot.
const PLACE: usize = 4;
/// Reals of a slot.
const SLOT: usize = 3;
/// Slots that are written at a time.
const SLOTS: usize = 7;

/// Most UAVs.
const UAVS: usize = WIDTH - 1;
/// Longest squared distance whose key is below [`NONE`].
const SQUARED_MAX: u32 = (NONE as u32 >> INDEX_BITS) - 1;

/// Sixty exchanges that sort sixteen keys, whatever the keys, so that all UAVs sort at once (M. W. Green, 1969; D. E.
/// Knuth, The Art of Computer Programming 3, 5.3.4). Written out in ten layers, as the compiler makes vector
/// instructions of a layer, but neither of a loop over the exchanges nor of all of them at once.
macro_rules! layers {
    ($layer:ident) => {
        $layer!(0 1, 2 3, 4 5, 6 7, 8 9, 10 11, 12 13, 14 15);
        $layer!(0 2, 4 6, 8 10, 12 14, 1 3, 5 7, 9 11, 13 15);
        $layer!(0 4, 8 12, 1 5, 9 13, 2 6, 10 14, 3 7, 11 15);
        $layer!(0 8, 1 9, 2 10, 3 11, 4 12, 5 13, 6 14, 7 15);
        $layer!(5 10, 6 9, 3 12, 13 14, 4 8, 7 11, 1 2);
        $layer!(1 4, 7 13, 2 8, 11 14);
        $layer!(2 4, 5 6, 9 10, 11 13, 3 8, 7 12);
        $layer!(6 8, 10 12, 3 5, 7 9);
        $layer!(3 4, 5 6, 7 8, 9 10, 11 12);
        $layer!(6 7, 8 9);
    };
}

/// For each UAV its neighbours by distance, ties to the lower index.
pub(crate) struct Ranking {
    /// Slot by slot a key for each UAV.
    keys: [Lanes<i16>; WIDTH],
    /// (1, x, y, 0) of each UAV as a neighbour, one after the other, and (0, x, y, 0) as an observer.
    places: [Lanes<f32>; PLACE],
    observers: [Lanes<f32>; PLACE],
    divisors: Divisors,
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
        macro_rules! layer {
            ($($a:literal $b:literal),+) => {
                $(
                    let (lower, upper) = keys.split_at_mut($b);
                    exchange(&mut lower[$a], &mut upper[0]);
                )+
            };
        }
        layers!(layer);
        let (mut places, mut observers) = ([[0.0; WIDTH]; PLACE], [[0.0; WIDTH]; PLACE]);
        for lane in 0..WIDTH {
            let (x, y, begin) = (f32::from(x[lane]), f32::from(y[lane]), PLACE * lane);
            places.as_flattened_mut()[begin..][..PLACE].copy_from_slice(&[1.0, x, y, 0.0]);
            observers.as_flattened_mut()[begin..][..PLACE].copy_from_slice(&[0.0, x, y, 0.0]);
        }
        in_memory(&mut places);
        in_memory(&mut observers);
        let (span_x, span_y) = model.offset_spans();
        Some(Self {
            keys,
            places,
            observers,
            divisors: Divisors::of([1.0, span_x, span_y, 1.0]),
        })
    }

    /// Writes (present, Δx/(W-1), Δy/(H-1)) for each of the slots of UAV i, with which `row` begins, and one real more.
    #[inline(always)]
    pub(crate) fn write(&self, i: usize, slots: usize, row: &mut [f32]) {
        let observer = &self.observers.as_flattened()[PLACE * i..][..PLACE];
        let own = repeat([observer[0], observer[1], observer[2], observer[3]]);
        let mut offsets = [[0.0; WIDTH]; PLACE];
        for (offsets, places) in offsets.iter_mut().zip(&self.places) {
            for lane in 0..WIDTH {
                offsets[lane] = self.divisors.offset(own[lane], places[lane], lane);
            }
            in_memory(offsets);
        }
        let offsets = offsets.as_flattened_mut();
        offsets[PLACE * UAVS..].fill(0.0);
        let neighbour = |slot: usize| {
            let index = self.keys[slot][i] as usize % WIDTH;
            &offsets[PLACE * index..][..PLACE]
        };
        let mut slot = 0;
        while slot + SLOTS <= slots {
            let room = row[SLOT * slot..]
                .first_chunk_mut::<{ SLOT * SLOTS + 1 }>()
                .expect("a real follows the last slot");
            for next in 0..SLOTS {
                room[SLOT * next..][..PLACE].copy_from_slice(neighbour(slot + next));
            }
            slot += SLOTS;
        }
        while slot < slots {
            row[SLOT * slot..][..PLACE].copy_from_slice(neighbour(slot));
            slot += 1;
        }
    }
}

/// Leaves the lesser key of each UAV in the first slot.
#[inline(always)]
fn exchange(first: &mut Lanes<i16>, second: &mut Lanes<i16>) {
    let (a, b) = (*first, *second);
    for lane in 0..WIDTH {
        first[lane] = a[lane].min(b[lane]);
    }
    for lane in 0..WIDTH {
        second[lane] = a[lane].max(b[lane]);
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
            macro_rules! layer {
                ($($a:literal $b:literal),+) => {
                    $( if keys >> $a & 1 > keys >> $b & 1 {
                        keys ^= 1 << $a | 1 << $b;
                    } )+
                };
            }
            layers!(layer);
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
