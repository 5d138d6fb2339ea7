//! Loops over UAVs in blocks of lanes, with the width of a block as a constant parameter.
//!
//! The compiler turns a loop over arrays of a fixed width into vector instructions of the target's
//! width. Every lane computes its formula in the same order, so that the bits are the same at any
//! width. A fleet that fills half a wide block is computed [`WIDE`] UAVs at a time. A smaller fleet
//! runs the same source at a width of one, where an array compiles to a scalar. [`at_width`]
//! chooses the width at the entry of each part of a step.
//!
//! Values at an index that differs between lanes are gathered into an array first. A bounds check
//! in the main loop would keep the compiler from vectorising it.
//!
//! The picture shows a block of eleven UAVs at a width of sixteen. Each half of the lanes is one
//! contiguous load from a row:
//!
//! ```text
//! row       0  1  2  3  4  5  6  7  8  9 10
//!
//! lane      0  1  2  3  4  5  6  7 | 8  9 10 11 12 13 14 15
//! UAV       0  1  2  3  4  5  6  7 | 3  4  5  6  7  8  9 10
//!           '--- first eight ----'   '-- last eight, of which the first five are spare copies
//! mask      1  1  1  1  1  1  1  1 | 0  0  0  0  0  1  1  1
//! ```

pub(crate) mod neighbours;
pub(crate) mod real;

use core::ops::Range;

use crate::config::Cell;

/// Number of UAVs in a wide block. Kani checks the same source at a width of two: two UAVs fill a
/// block, and three take a second block that is not full.
pub(crate) const WIDE: usize = if cfg!(kani) { 2 } else { 16 };

/// Smallest fleet that is computed in wide blocks; for fewer UAVs a width of one costs less. Under
/// Kani every fleet is computed in wide blocks, so that its two UAVs do not run at a width of one.
pub(crate) const WIDE_FLEET: usize = if cfg!(kani) { 1 } else { 8 };

/// The width of the blocks of a fleet.
#[cfg(not(test))]
#[inline(always)]
pub(crate) const fn width_of(uavs: usize) -> usize {
    if uavs < WIDE_FLEET { 1 } else { WIDE }
}

/// Calls a part of a step at the fleet's width.
macro_rules! at_width {
    ($model:expr, $part:ident($($argument:expr),* $(,)?)) => {
        match $crate::lanes::width_of($model.uav_count()) {
            1 => $part::<1>($($argument),*),
            // Tests also run at the width of Kani's proofs.
            #[cfg(test)]
            2 => $part::<2>($($argument),*),
            _ => $part::<{ $crate::lanes::WIDE }>($($argument),*),
        }
    };
}
pub(crate) use at_width;

/// A value for each lane of a block.
pub(crate) type Lanes<T, const W: usize> = [T; W];

/// A value aligned to a cache line. A vector across two lines is slower to load, and one across two
/// pages much slower.
#[repr(align(64))]
#[derive(Clone, Copy)]
pub(crate) struct CacheAligned<T>(pub(crate) T);

/// A block: the UAVs `first..first + count`, each in a lane.
///
/// Lanes 0–7 hold the first eight UAVs, and lanes 8–15 hold the last eight. So both halves are
/// contiguous loads; a load that spans two recent stores would defeat store forwarding. With 9–15
/// UAVs the middle ones appear twice, and the copies in the second half are ignored. A block of
/// fewer than eight UAVs uses the first half only.
#[derive(Clone, Copy)]
pub(crate) struct Block<const W: usize> {
    pub(crate) first: usize,
    pub(crate) count: usize,
}

/// The blocks of a fleet; the last one may not be full.
#[inline(always)]
pub(crate) fn blocks<const W: usize>(uavs: usize) -> impl Iterator<Item = Block<W>> {
    blocks_of(0..uavs)
}

/// The blocks of a part of a fleet, which begins at a multiple of the width.
#[inline(always)]
pub(crate) fn blocks_of<const W: usize>(uavs: Range<usize>) -> impl Iterator<Item = Block<W>> {
    let end = uavs.end;
    uavs.step_by(W).map(move |first| Block {
        first,
        // A block of width one is always full, which the compiler does not deduce.
        count: if W == 1 || end - first >= W {
            W
        } else {
            end - first
        },
    })
}

impl<const W: usize> Block<W> {
    /// Number of lanes in the first half; a width of one has no second half.
    const HALF: usize = W.div_ceil(2);
    const FIRST_HALF: u64 = (1 << Self::HALF) - 1;

    /// Number of spare lanes, which come first in the second half.
    #[inline(always)]
    const fn spare(self) -> usize {
        if self.count < Self::HALF {
            0
        } else {
            W - self.count
        }
    }

    /// The lane of the UAV with this index in the block.
    #[inline(always)]
    pub(crate) const fn lane(self, index: usize) -> usize {
        let lane = if index < Self::HALF {
            index
        } else {
            index + self.spare()
        };
        lane % W
    }

    /// The lanes of the UAVs, in the order of the UAVs.
    #[inline(always)]
    pub(crate) fn lanes(self) -> impl Iterator<Item = usize> {
        (0..self.count).map(move |index| self.lane(index))
    }

    /// The values of the UAVs in their order, as two slices.
    #[inline(always)]
    pub(crate) fn in_order<T>(self, lanes: &Lanes<T, W>) -> [&[T]; 2] {
        let (first, last) = lanes.split_at(Self::HALF);
        if self.count < Self::HALF {
            [&first[..self.count], &[]]
        } else {
            [first, &last[self.spare()..]]
        }
    }

    /// For each lane, the index in the block of its UAV.
    #[inline(always)]
    pub(crate) fn indices(self) -> Lanes<u32, W> {
        let (mut indices, spare) = ([0; W], self.spare() as u32);
        for lane in 0..W {
            indices[lane] = lane as u32 - if lane < Self::HALF { 0 } else { spare };
        }
        indices
    }

    /// Loads the block's part of a row that has an entry for each UAV. Spare lanes hold a copy or
    /// `T::default()`.
    #[inline(always)]
    pub(crate) fn load<T: Copy + Default>(self, row: &[T]) -> Lanes<T, W> {
        let row = &row[self.first..self.first + self.count];
        let mut few = [T::default(); W];
        let (first, last) = if row.len() < Self::HALF {
            few[..row.len()].copy_from_slice(row);
            (&few[..Self::HALF], &few[..W - Self::HALF])
        } else {
            let begin = row.len() - (W - Self::HALF);
            (&row[..Self::HALF], &row[begin..])
        };
        let mut lanes = [T::default(); W];
        lanes[..Self::HALF].copy_from_slice(first);
        lanes[Self::HALF..].copy_from_slice(last);
        lanes
    }

    /// Stores the lanes of the UAVs into a row that has an entry for each UAV.
    #[inline(always)]
    pub(crate) fn store<T: Copy>(self, lanes: &Lanes<T, W>, row: &mut [T]) {
        let row = &mut row[self.first..self.first + self.count];
        let (first, last) = lanes.split_at(Self::HALF);
        if row.len() < Self::HALF {
            for (entry, &lane) in row.iter_mut().zip(first) {
                *entry = lane;
            }
        } else {
            // The second half is stored first, so that the first half overwrites its spare lanes.
            let begin = row.len() - last.len();
            row[begin..].copy_from_slice(last);
            row[..Self::HALF].copy_from_slice(first);
        }
    }

    /// Loads word `word` of each UAV's row of bits in `rows`, where a row has `len` words.
    #[inline(always)]
    pub(crate) fn load_word(self, rows: &[u64], len: usize, word: usize) -> Lanes<u64, W> {
        if len == 1 {
            return self.load(rows);
        }
        let mut lanes = [0; W];
        let rows = rows[self.first * len..].chunks_exact(len);
        for (lane, row) in self.lanes().zip(rows) {
            lanes[lane] = row[word];
        }
        lanes
    }

    /// Stores the words that [`Block::load_word`] loads.
    #[inline(always)]
    pub(crate) fn store_word(
        self,
        lanes: &Lanes<u64, W>,
        rows: &mut [u64],
        len: usize,
        word: usize,
    ) {
        if len == 1 {
            return self.store(lanes, rows);
        }
        let rows = rows[self.first * len..].chunks_exact_mut(len);
        for (lane, row) in self.lanes().zip(rows) {
            row[word] = lanes[lane];
        }
    }

    /// Converts a set of UAVs to a set of lanes. A block never spans two words of the set.
    #[inline(always)]
    pub(crate) fn bits(self, set: &[u64]) -> u64 {
        self.lanes_of(set[self.first / 64] >> (self.first % 64) & self.uavs())
    }

    /// Converts a set of indices in the block to a set of lanes.
    #[inline(always)]
    pub(crate) fn lanes_of(self, uavs: u64) -> u64 {
        uavs & Self::FIRST_HALF | uavs >> Self::HALF << (Self::HALF + self.spare())
    }

    /// Stores a set of lanes into a set of UAVs.
    #[inline(always)]
    pub(crate) fn put_bits(self, bits: u64, set: &mut [u64]) {
        let (word, shift) = (self.first / 64, self.first % 64);
        set[word] = set[word] & !(self.uavs() << shift) | self.uavs_in(bits) << shift;
    }

    /// Converts a set of lanes to a set of indices in the block.
    #[inline(always)]
    pub(crate) fn uavs_in(self, bits: u64) -> u64 {
        (bits & Self::FIRST_HALF | bits >> (Self::HALF + self.spare()) << Self::HALF) & self.uavs()
    }

    #[inline(always)]
    fn uavs(self) -> u64 {
        u64::MAX >> (64 - self.count)
    }

    /// The set of lanes that are not spare.
    #[inline(always)]
    pub(crate) fn mask(self) -> u64 {
        self.lanes_of(self.uavs())
    }
}

/// All ones for true, 0 for false.
#[inline(always)]
pub(crate) fn ones(yes: bool) -> u64 {
    0u64.wrapping_sub(u64::from(yes))
}

/// For each lane, all ones if its bit is set, else 0.
#[inline(always)]
pub(crate) fn spread<const W: usize>(bits: u64) -> Lanes<u64, W> {
    let mut lanes = [0; W];
    for lane in 0..W {
        let bit = 1 << lane;
        lanes[lane] = if bits & bit == bit { u64::MAX } else { 0 };
    }
    force_vector(&mut lanes);
    lanes
}

/// The sum over the lanes.
#[inline(always)]
pub(crate) fn sum<const W: usize>(lanes: &Lanes<u64, W>) -> u64 {
    let mut sum = 0;
    for lane in 0..W {
        sum += lanes[lane];
    }
    sum
}

/// The set of lanes that are all ones; the other lanes must be 0.
#[inline(always)]
pub(crate) fn gather_bits<const W: usize>(lanes: &Lanes<u64, W>) -> u64 {
    let mut set = [0; W];
    for lane in 0..W {
        set[lane] = lanes[lane] & 1 << lane;
    }
    force_vector(&mut set);
    let mut bits = 0;
    for lane in 0..W {
        bits |= set[lane];
    }
    bits
}

/// Cells, one for each lane of a block.
#[derive(Clone, Copy)]
pub(crate) struct Cells<const W: usize> {
    pub(crate) x: Lanes<i32, W>,
    pub(crate) y: Lanes<i32, W>,
}

impl<const W: usize> Cells<W> {
    #[inline(always)]
    pub(crate) fn load(block: Block<W>, words: &[u64]) -> Self {
        Self::of(&block.load(words))
    }

    #[inline(always)]
    pub(crate) fn of(words: &Lanes<u64, W>) -> Self {
        let (mut x, mut y) = ([0; W], [0; W]);
        for lane in 0..W {
            x[lane] = words[lane] as u32 as i32;
            y[lane] = (words[lane] >> 32) as i32;
        }
        force_vector(&mut x);
        force_vector(&mut y);
        Self { x, y }
    }

    /// Row-major indices of the cells in a grid of this width.
    #[inline(always)]
    pub(crate) fn index(&self, width: u32) -> Lanes<u32, W> {
        let mut index = [0; W];
        for lane in 0..W {
            index[lane] = (self.y[lane] * width as i32 + self.x[lane]) as u32;
        }
        force_vector(&mut index);
        index
    }

    /// The cells as columns and row offsets in a grid of this width.
    #[inline(always)]
    pub(crate) fn rows(&self, width: u32) -> Rows<W> {
        let mut begin = [0; W];
        for lane in 0..W {
            begin[lane] = self.y[lane] * width as i32;
        }
        force_vector(&mut begin);
        let (mut byte_x, mut byte_begin) = ([0; W], [0; W]);
        for lane in 0..W {
            byte_x[lane] = self.x[lane] as u8;
            byte_begin[lane] = begin[lane] as u8;
        }
        force_vector(&mut byte_x);
        force_vector(&mut byte_begin);
        Rows {
            x: self.x,
            begin,
            byte_x,
            byte_begin,
        }
    }
}

/// Cells in a grid, one for each lane: their columns, and the indices at which their rows begin.
#[derive(Clone, Copy)]
pub(crate) struct Rows<const W: usize> {
    x: Lanes<i32, W>,
    begin: Lanes<i32, W>,
    /// `x` and `begin` as bytes, for a grid of at most 256 cells.
    byte_x: Lanes<u8, W>,
    byte_begin: Lanes<u8, W>,
}

impl<const W: usize> Rows<W> {
    /// Gathers the words of a table at the row-major index of the absolute offset to a cell.
    ///
    /// The table has `len` entries; `table` may hold more words after it.
    #[inline(always)]
    pub(crate) fn gather(
        &self,
        table: &[u64],
        len: usize,
        to: Cell,
        width: u32,
        words: &mut Lanes<u64, W>,
    ) {
        match in_bytes::<W>(table, len) {
            Some(table) => gather_bytes(table, self.byte_offsets(to, width), words),
            None => gather_words(table, self.offsets(to, width), words),
        }
    }

    #[inline(always)]
    fn offsets(&self, to: Cell, width: u32) -> Lanes<u32, W> {
        let (x, begin) = (to.x as i32, (to.y * width) as i32);
        let mut index = [0; W];
        for lane in 0..W {
            index[lane] =
                (self.begin[lane] - begin).unsigned_abs() + (self.x[lane] - x).unsigned_abs();
        }
        index
    }

    #[inline(always)]
    fn byte_offsets(&self, to: Cell, width: u32) -> Lanes<u8, W> {
        let (x, begin) = (to.x as u8, (to.y * width) as u8);
        let mut index = [0; W];
        for lane in 0..W {
            index[lane] = (self.byte_begin[lane].max(begin) - self.byte_begin[lane].min(begin))
                + (self.byte_x[lane].max(x) - self.byte_x[lane].min(x));
        }
        index
    }
}

/// Stops LLVM from scalarising an array of lanes, which it does when lanes are later used
/// individually. It affects speed alone, and does nothing at a width of one.
#[inline(always)]
pub(crate) fn force_vector<T, const W: usize>(lanes: &mut [T; W]) {
    if W > 1 {
        core::hint::black_box(lanes);
    }
}

/// Largest table whose indices fit a byte, which needs no bounds check.
const BYTE: usize = 256;

/// The table as one with byte indices, if it is small. `None` at a width of one, where a bounds
/// check costs no more than the conversion to a byte.
#[inline(always)]
fn in_bytes<const W: usize>(table: &[u64], len: usize) -> Option<&[u64; BYTE]> {
    if W > 1 && len <= BYTE {
        table.first_chunk()
    } else {
        None
    }
}

/// Gathers the words of a table at an index for each lane. The table has `len` entries; `table` may
/// hold more words after it.
#[inline(always)]
pub(crate) fn gather<const W: usize>(
    table: &[u64],
    len: usize,
    index: &Lanes<u32, W>,
) -> Lanes<u64, W> {
    let mut words = [0; W];
    match in_bytes::<W>(table, len) {
        Some(table) => gather_bytes(table, index.map(|index| index as u8), &mut words),
        None => gather_words(table, *index, &mut words),
    }
    words
}

#[inline(always)]
fn gather_bytes<const W: usize>(
    table: &[u64; BYTE],
    mut index: Lanes<u8, W>,
    words: &mut Lanes<u64, W>,
) {
    force_vector(&mut index);
    for lane in 0..W {
        words[lane] = table[usize::from(index[lane])];
    }
}

#[inline(always)]
fn gather_words<const W: usize>(
    table: &[u64],
    mut index: Lanes<u32, W>,
    words: &mut Lanes<u64, W>,
) {
    force_vector(&mut index);
    for lane in 0..W {
        words[lane] = table[index[lane] as usize];
    }
}

/// A width that tests set in place of the fleet's own.
#[cfg(test)]
pub(crate) mod forced {
    use core::cell::Cell;

    std::thread_local! {
        static WIDTH: Cell<Option<usize>> = const { Cell::new(None) };
    }

    /// Runs a closure at a width of 1, 2 or [`super::WIDE`].
    pub(crate) fn at<T>(width: usize, fly: impl FnOnce() -> T) -> T {
        let before = WIDTH.replace(Some(width));
        let result = fly();
        WIDTH.set(before);
        result
    }

    /// Sets the width for the rest of this thread.
    pub(crate) fn set(width: usize) {
        WIDTH.set(Some(width));
    }

    pub(super) fn width() -> Option<usize> {
        WIDTH.get()
    }
}

/// The width of the blocks of a fleet, or the width that a test set.
#[cfg(test)]
pub(crate) fn width_of(uavs: usize) -> usize {
    forced::width().unwrap_or(if uavs < WIDE_FLEET { 1 } else { WIDE })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn a_fleet_of_any_size_is_read_and_written_whole() {
        fn at<const W: usize>(uavs: usize) {
            let row: Vec<u64> = (1..=uavs as u64).collect();
            let mut copy = std::vec![0; uavs];
            let mut visited = 0;
            for block in blocks::<W>(uavs) {
                assert_eq!(block.first, visited);
                visited += block.count;
                let lanes = block.load(&row);
                let own = block.lanes().map(|lane| lanes[lane]);
                assert!(own.eq(row[block.first..][..block.count].iter().copied()));
                assert_eq!(
                    block.in_order(&lanes).concat(),
                    row[block.first..][..block.count]
                );
                let mask: Lanes<u64, W> = spread(block.mask());
                let counted = (0..W).filter(|&lane| mask[lane] != 0);
                assert!(counted.eq(block.lanes()));
                for (lane, &index) in block.indices().iter().enumerate() {
                    let copy = row.get(block.first + index as usize).copied();
                    assert!(block.count < Block::<W>::HALF || copy == Some(lanes[lane]));
                }
                block.store(&lanes, &mut copy);
            }
            assert_eq!((visited, copy), (uavs, row));
        }
        for uavs in 1..=70 {
            at::<1>(uavs);
            at::<2>(uavs);
            at::<16>(uavs);
        }
    }

    #[test]
    fn words_of_rows_are_those_of_each_uav() {
        fn at<const W: usize>(uavs: usize, len: usize) {
            let rows: Vec<u64> = (0..(uavs * len) as u64).collect();
            let mut copy = std::vec![0; uavs * len];
            for block in blocks::<W>(uavs) {
                for word in 0..len {
                    let lanes = block.load_word(&rows, len, word);
                    for (index, lane) in block.lanes().enumerate() {
                        assert_eq!(lanes[lane], rows[(block.first + index) * len + word]);
                    }
                    block.store_word(&lanes, &mut copy, len, word);
                }
            }
            assert_eq!(copy, rows);
        }
        for (uavs, len) in [(7, 1), (15, 1), (15, 3), (37, 2)] {
            at::<1>(uavs, len);
            at::<2>(uavs, len);
            at::<16>(uavs, len);
        }
    }

    #[test]
    fn bits_of_a_block_leave_the_others_alone() {
        fn at<const W: usize>() {
            let mut set = [0x0123_4567_89AB_CDEF, 0xFEDC_BA98_7654_3210];
            for block in blocks::<W>(100) {
                let before = set;
                let bits = block.bits(&set);
                assert_eq!(gather_bits(&spread::<W>(bits)), bits);
                assert_eq!(
                    block.uavs_in(bits),
                    before[block.first / 64] >> (block.first % 64)
                        & (u64::MAX >> (64 - block.count))
                );
                block.put_bits(!bits, &mut set);
                assert_eq!(block.bits(&set), !bits & block.mask());
                block.put_bits(bits, &mut set);
                assert_eq!(set, before);
            }
        }
        at::<1>();
        at::<2>();
        at::<16>();
    }
}
