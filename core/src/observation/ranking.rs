//! The neighbours of every UAV, nearest first, in small fleets.

use crate::lanes::real::{Divisors, ENTRIES, repeat};
use crate::lanes::{Block, CacheAligned, Cells, Lanes, force_vector};
use crate::model::Model;
use crate::state::StateRef;

/// Number of lanes of the block in which a fleet is ranked. The exchanges below sort one key less.
const WIDTH: usize = 16;

/// Bits of a UAV's lane in a key; the squared distance takes the bits above.
const LANE_BITS: u32 = WIDTH.trailing_zeros();
/// Key of an absent neighbour. It is above every other key, and its lane is spare, because the
/// fleet does not fill all lanes.
const NONE: i16 = i16::MAX & !(WIDTH as i16 - 1) | SPARE as i16;
const SPARE: usize = WIDTH / 2;

/// Number of reals that are stored for a neighbour; the next slot overwrites the last one.
const PLACE: usize = 4;
/// Number of reals of a slot.
const SLOT: usize = 3;
/// Number of slots that are written at a time.
const SLOTS: usize = 7;

/// Smallest fleet that is ranked here. For fewer UAVs, sorting one by one costs less, and a spare
/// lane exists only from half a block on.
const FEWEST: usize = WIDTH / 2;
/// Largest fleet that is ranked here.
const UAVS: usize = WIDTH - 1;
/// Longest squared distance whose key is below [`NONE`].
const SQUARED_MAX: u32 = (NONE as u32 >> LANE_BITS) - 1;

/// A sorting network for fifteen keys, with which all UAVs sort at the same time.
///
/// It is the network of sixty exchanges for sixteen keys without the four of the last key (M. W.
/// Green, 1969; D. E. Knuth, The Art of Computer Programming 3, 5.3.4). It is written out in ten
/// layers, because the compiler vectorises a layer. It vectorises neither a loop over the exchanges
/// nor all layers at once.
macro_rules! layers {
    ($layer:ident) => {
        $layer!(0 1, 2 3, 4 5, 6 7, 8 9, 10 11, 12 13);
        $layer!(0 2, 4 6, 8 10, 12 14, 1 3, 5 7, 9 11);
        $layer!(0 4, 8 12, 1 5, 9 13, 2 6, 10 14, 3 7);
        $layer!(0 8, 1 9, 2 10, 3 11, 4 12, 5 13, 6 14);
        $layer!(5 10, 6 9, 3 12, 13 14, 4 8, 7 11, 1 2);
        $layer!(1 4, 7 13, 2 8, 11 14);
        $layer!(2 4, 5 6, 9 10, 11 13, 3 8, 7 12);
        $layer!(6 8, 10 12, 3 5, 7 9);
        $layer!(3 4, 5 6, 7 8, 9 10, 11 12);
        $layer!(6 7, 8 9);
    };
}

/// The neighbours of each UAV by distance; ties go to the lower index.
pub(crate) struct Ranking {
    block: Block<WIDTH>,
    /// Slot by slot, for each UAV where in `offsets` its neighbour begins.
    begins: CacheAligned<[Lanes<u8, WIDTH>; UAVS]>,
    /// (1, x, y, 0) of each UAV as a neighbour, one after the other, and (0, x, y, 0) as an
    /// observer.
    places: CacheAligned<[Lanes<f32, WIDTH>; PLACE]>,
    observers: CacheAligned<[Lanes<f32, WIDTH>; PLACE]>,
    /// (1, Δx, Δy, 0) of one UAV after the other; as long as a byte that is an index needs no
    /// check.
    offsets: CacheAligned<[f32; 1 << u8::BITS | PLACE]>,
    divisors: Divisors,
}

impl Ranking {
    /// Returns `None` if the fleet or the grid is too large for 16-bit keys, or the fleet too small
    /// for a gain.
    #[inline(always)]
    pub(crate) fn room(model: &Model<'_>) -> Option<Self> {
        let count = model.uav_count();
        let (dx, dy) = (
            model.config().grid_width - 1,
            model.config().grid_height - 1,
        );
        if count < FEWEST || count > UAVS || dx * dx + dy * dy > SQUARED_MAX {
            return None;
        }
        let (span_x, span_y) = model.offset_spans();
        Some(Self {
            block: Block { first: 0, count },
            begins: CacheAligned([[0; WIDTH]; UAVS]),
            places: CacheAligned([[0.0; WIDTH]; PLACE]),
            observers: CacheAligned([[0.0; WIDTH]; PLACE]),
            offsets: CacheAligned([0.0; 1 << u8::BITS | PLACE]),
            divisors: Divisors::of([1.0, span_x, span_y, 1.0]),
        })
    }

    #[inline(always)]
    pub(crate) fn rank(&mut self, state: &StateRef<'_>) {
        let block = self.block;
        let cells = Cells::load(block, state.cells);
        let (mut x, mut y) = ([0i16; WIDTH], [0i16; WIDTH]);
        for lane in 0..WIDTH {
            x[lane] = cells.x[lane] as i16;
            y[lane] = cells.y[lane] as i16;
        }
        force_vector(&mut x);
        force_vector(&mut y);
        let CacheAligned(keys) = &mut CacheAligned([[NONE; WIDTH]; UAVS]);
        for (k, row) in keys[..block.count].iter_mut().enumerate() {
            // The graph is symmetric: the neighbours of k are those that have k as a neighbour.
            let (linked, neighbour) = (block.lanes_of(state.links[k]) as i16, block.lane(k));
            let (kx, ky) = (x[neighbour], y[neighbour]);
            for lane in 0..WIDTH {
                let (dx, dy) = (x[lane] - kx, y[lane] - ky);
                let key = (dx * dx + dy * dy) << LANE_BITS | neighbour as i16;
                row[lane] = if linked & 1 << lane != 0 { key } else { NONE };
            }
            force_vector(row);
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
        for (begins, keys) in self.begins.0.iter_mut().zip(keys) {
            for lane in 0..WIDTH {
                begins[lane] = (keys[lane] as usize % WIDTH * PLACE) as u8;
            }
            force_vector(begins);
        }
        let places = self.places.0.as_flattened_mut().chunks_exact_mut(PLACE);
        let observers = self.observers.0.as_flattened_mut().chunks_exact_mut(PLACE);
        for ((place, observer), (&x, &y)) in places.zip(observers).zip(x.iter().zip(&y)) {
            let (x, y) = (f32::from(x), f32::from(y));
            place.copy_from_slice(&[1.0, x, y, 0.0]);
            observer.copy_from_slice(&[0.0, x, y, 0.0]);
        }
        force_vector(&mut self.places.0);
        force_vector(&mut self.observers.0);
    }

    /// Writes (present, Δx/(W-1), Δy/(H-1)) for each slot of UAV i from the start of `row`, and one
    /// extra real after the last slot.
    #[inline(always)]
    pub(crate) fn write(&mut self, i: usize, slots: usize, row: &mut [f32]) {
        let lane = self.block.lane(i);
        let observer = &self.observers.0.as_flattened()[PLACE * lane..][..PLACE];
        let own = repeat([observer[0], observer[1], observer[2], observer[3]]);
        let (offsets, _) = self.offsets.0.as_chunks_mut::<ENTRIES>();
        for (offsets, places) in offsets.iter_mut().zip(&self.places.0) {
            for lane in 0..WIDTH {
                offsets[lane] = self.divisors.offset(own[lane], places[lane], lane);
            }
            force_vector(offsets);
        }
        self.offsets.0[PLACE * SPARE..][..PLACE].fill(0.0);
        let neighbour = |slot: usize| {
            let begin = usize::from(self.begins.0[slot][lane]);
            &self.offsets.0[begin..begin + PLACE]
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
fn exchange(first: &mut Lanes<i16, WIDTH>, second: &mut Lanes<i16, WIDTH>) {
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
        for ones in 0..1u32 << UAVS {
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
            assert_eq!(keys, (0x7FFF << (15 - count)) & 0x7FFF, "{ones:015b}");
        }
    }

    #[test]
    fn keys_stay_below_none() {
        let largest = SQUARED_MAX << LANE_BITS | (WIDTH as u32 - 1);
        assert!(largest < NONE as u32);
        for count in FEWEST..=UAVS {
            let block = Block::<WIDTH> { first: 0, count };
            assert!(block.lanes().all(|lane| lane != NONE as usize % WIDTH));
        }
    }
}
