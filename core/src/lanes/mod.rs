//! The hot loops of a step, sixteen UAVs side by side.
//!
//! A loop over arrays of a fixed width becomes vector instructions, of whatever width the target has. Every lane
//! computes what the plain formula computes, in its order, so that the bits are the same with any of them; the
//! plain formula stays beside it, for fleets that are too small to fill the lanes, and the tests compare both.
//!
//! What is read by an index that differs between lanes is gathered into an array first: a check of its bounds in
//! the loop would keep the compiler from vectorising the rest.

pub(crate) mod neighbours;
pub(crate) mod real;

use crate::config::Cell;

/// UAVs in a block.
pub(crate) const WIDTH: usize = 16;
pub(crate) const HALF: usize = WIDTH / 2;
const FIRST_HALF: u64 = (1 << HALF) - 1;

/// Fleets from this size on fly in lanes: for fewer, one UAV after the other costs less.
pub(crate) const FLEET: usize = HALF;

/// A value for each UAV of a block.
pub(crate) type Lanes<T> = [T; WIDTH];

/// Begins at a line of the cache: a vector that lies in two lines is slower, and one in two pages much slower.
#[repr(align(64))]
#[derive(Clone, Copy)]
pub(crate) struct Lined<T>(pub(crate) T);

/// The UAVs `first..first + count`, each in a lane.
///
/// The first eight have the first half of the lanes. Of more than eight the last eight have the other half, so that each
/// half is a part of a row as it stands: a load that spans two stores just made would wait for both. UAVs in the middle
/// then have two lanes, of which that in the second half is spare: it holds a copy, which nothing counts.
#[derive(Clone, Copy)]
pub(crate) struct Block {
    pub(crate) first: usize,
    pub(crate) count: usize,
}

/// A fleet in blocks; the last may not be full.
#[inline(always)]
pub(crate) fn blocks(uavs: usize) -> impl Iterator<Item = Block> {
    (0..uavs).step_by(WIDTH).map(move |first| Block {
        first,
        count: if uavs - first < WIDTH {
            uavs - first
        } else {
            WIDTH
        },
    })
}

/// A fleet in blocks, or its UAVs one by one where they are too few for lanes.
#[inline(always)]
pub(crate) fn split(uavs: usize) -> (impl Iterator<Item = Block>, core::ops::Range<usize>) {
    if uavs < FLEET {
        (blocks(0), 0..uavs)
    } else {
        (blocks(uavs), 0..0)
    }
}

impl Block {
    /// Spare lanes, which begin the second half.
    #[inline(always)]
    const fn spare(self) -> usize {
        if self.count < HALF {
            0
        } else {
            WIDTH - self.count
        }
    }

    /// The lane of a UAV, by its index in the block.
    #[inline(always)]
    pub(crate) const fn lane(self, index: usize) -> usize {
        let lane = if index < HALF {
            index
        } else {
            index + self.spare()
        };
        lane % WIDTH
    }

    /// The lanes of the UAVs, one after the other.
    #[inline(always)]
    pub(crate) fn lanes(self) -> impl Iterator<Item = usize> {
        (0..self.count).map(move |index| self.lane(index))
    }

    /// The lanes of the UAVs in their order, in two parts.
    #[inline(always)]
    pub(crate) fn in_order<T>(self, lanes: &Lanes<T>) -> [&[T]; 2] {
        let (first, last) = lanes.split_at(HALF);
        if self.count < HALF {
            [&first[..self.count], &[]]
        } else {
            [first, &last[self.spare()..]]
        }
    }

    /// The UAV of each lane, by its index in the block.
    #[inline(always)]
    pub(crate) fn indices(self) -> Lanes<u32> {
        let (mut indices, spare) = ([0; WIDTH], self.spare() as u32);
        for lane in 0..WIDTH {
            indices[lane] = lane as u32 - if lane < HALF { 0 } else { spare };
        }
        indices
    }

    /// The block's part of a row with an entry for each UAV; lanes without a UAV hold a copy or `T::default()`.
    #[inline(always)]
    pub(crate) fn load<T: Copy + Default>(self, row: &[T]) -> Lanes<T> {
        let row = &row[self.first..self.first + self.count];
        let mut few = [T::default(); HALF];
        let (first, last) = match (row.first_chunk(), row.last_chunk()) {
            (Some(first), Some(last)) => (first, last),
            _ => {
                few[..row.len()].copy_from_slice(row);
                (&few, &few)
            }
        };
        let mut lanes = [T::default(); WIDTH];
        lanes[..HALF].copy_from_slice(first);
        lanes[HALF..].copy_from_slice(last);
        lanes
    }

    /// Writes the lanes of the UAVs.
    #[inline(always)]
    pub(crate) fn store<T: Copy>(self, lanes: &Lanes<T>, row: &mut [T]) {
        let row = &mut row[self.first..self.first + self.count];
        if let Some(last) = row.last_chunk_mut::<HALF>() {
            // Spare lanes first: what they hold is written over.
            last.copy_from_slice(&lanes[HALF..]);
            row[..HALF].copy_from_slice(&lanes[..HALF]);
        } else {
            for (entry, &lane) in row.iter_mut().zip(lanes) {
                *entry = lane;
            }
        }
    }

    /// Word `word` of the row of bits that each UAV has in `rows`, rows being `len` words long.
    #[inline(always)]
    pub(crate) fn load_word(self, rows: &[u64], len: usize, word: usize) -> Lanes<u64> {
        if len == 1 {
            return self.load(rows);
        }
        let mut lanes = [0; WIDTH];
        let rows = rows[self.first * len..].chunks_exact(len);
        for (lane, row) in self.lanes().zip(rows) {
            lanes[lane] = row[word];
        }
        lanes
    }

    /// Writes what [`Block::load_word`] reads.
    #[inline(always)]
    pub(crate) fn store_word(self, lanes: &Lanes<u64>, rows: &mut [u64], len: usize, word: usize) {
        if len == 1 {
            return self.store(lanes, rows);
        }
        let rows = rows[self.first * len..].chunks_exact_mut(len);
        for (lane, row) in self.lanes().zip(rows) {
            row[word] = lanes[lane];
        }
    }

    /// The lanes of a set of UAVs. A block never straddles two words of the set.
    #[inline(always)]
    pub(crate) fn bits(self, set: &[u64]) -> u64 {
        self.lanes_of(set[self.first / 64] >> (self.first % 64) & self.uavs())
    }

    /// The lanes of a set of UAVs, by their index in the block.
    #[inline(always)]
    pub(crate) fn lanes_of(self, uavs: u64) -> u64 {
        uavs & FIRST_HALF | uavs >> HALF << (HALF + self.spare())
    }

    /// Writes the UAVs of a set of lanes.
    #[inline(always)]
    pub(crate) fn put_bits(self, bits: u64, set: &mut [u64]) {
        let (word, shift) = (self.first / 64, self.first % 64);
        set[word] = set[word] & !(self.uavs() << shift) | self.uavs_in(bits) << shift;
    }

    /// The UAVs of a set of lanes, by their index in the block.
    #[inline(always)]
    pub(crate) fn uavs_in(self, bits: u64) -> u64 {
        (bits & FIRST_HALF | bits >> (HALF + self.spare()) << HALF) & self.uavs()
    }

    #[inline(always)]
    fn uavs(self) -> u64 {
        u64::MAX >> (64 - self.count)
    }

    /// The lanes that have a UAV of their own.
    #[inline(always)]
    pub(crate) fn mask(self) -> u64 {
        self.lanes_of(self.uavs())
    }
}

/// The same four entries over and over.
#[inline(always)]
pub(crate) fn repeat(entries: [f32; 4]) -> Lanes<f32> {
    let mut lanes = [0.0; WIDTH];
    for lane in 0..WIDTH {
        lanes[lane] = entries[lane % 4];
    }
    lanes
}

/// For each lane, all ones where its bit is set.
#[inline(always)]
pub(crate) fn spread(bits: u64) -> Lanes<u64> {
    let mut lanes = [0; WIDTH];
    for lane in 0..WIDTH {
        let bit = 1 << lane;
        lanes[lane] = if bits & bit == bit { u64::MAX } else { 0 };
    }
    in_memory(&mut lanes);
    lanes
}

/// The sum over the lanes.
#[inline(always)]
pub(crate) fn sum(lanes: &Lanes<u64>) -> u64 {
    let mut sum = 0;
    for lane in 0..WIDTH {
        sum += lanes[lane];
    }
    sum
}

/// The set of lanes that are all ones; the others are 0.
#[inline(always)]
pub(crate) fn gather_bits(lanes: &Lanes<u64>) -> u64 {
    let mut set = [0; WIDTH];
    for lane in 0..WIDTH {
        set[lane] = lanes[lane] & 1 << lane;
    }
    in_memory(&mut set);
    let mut bits = 0;
    for lane in 0..WIDTH {
        bits |= set[lane];
    }
    bits
}

/// The cells of a block.
#[derive(Clone, Copy)]
pub(crate) struct Cells {
    pub(crate) x: Lanes<i32>,
    pub(crate) y: Lanes<i32>,
}

impl Cells {
    #[inline(always)]
    pub(crate) fn load(block: Block, words: &[u64]) -> Self {
        Self::of(&block.load(words))
    }

    #[inline(always)]
    pub(crate) fn of(words: &Lanes<u64>) -> Self {
        let (mut x, mut y) = ([0; WIDTH], [0; WIDTH]);
        for lane in 0..WIDTH {
            x[lane] = words[lane] as u32 as i32;
            y[lane] = (words[lane] >> 32) as i32;
        }
        in_memory(&mut x);
        in_memory(&mut y);
        Self { x, y }
    }

    /// Row-major indices in a grid.
    #[inline(always)]
    pub(crate) fn index(&self, width: u32) -> Lanes<u32> {
        let mut index = [0; WIDTH];
        for lane in 0..WIDTH {
            index[lane] = (self.y[lane] * width as i32 + self.x[lane]) as u32;
        }
        in_memory(&mut index);
        index
    }

    /// The cells in a grid, row by row.
    #[inline(always)]
    pub(crate) fn rows(&self, width: u32) -> Rows {
        let mut begin = [0; WIDTH];
        for lane in 0..WIDTH {
            begin[lane] = self.y[lane] * width as i32;
        }
        in_memory(&mut begin);
        let (mut byte_x, mut byte_begin) = ([0; WIDTH], [0; WIDTH]);
        for lane in 0..WIDTH {
            byte_x[lane] = self.x[lane] as u8;
            byte_begin[lane] = begin[lane] as u8;
        }
        in_memory(&mut byte_x);
        in_memory(&mut byte_begin);
        Rows {
            x: self.x,
            begin,
            byte_x,
            byte_begin,
        }
    }
}

/// The cells of a block in a grid: their columns, and where their rows begin.
#[derive(Clone, Copy)]
pub(crate) struct Rows {
    x: Lanes<i32>,
    begin: Lanes<i32>,
    /// The same in a byte, for a grid whose cells have indices of a byte.
    byte_x: Lanes<u8>,
    byte_begin: Lanes<u8>,
}

impl Rows {
    /// The words of a table, `len` entries long, at the row-major index of the absolute offset to a cell of the grid.
    /// What follows the table may be given too.
    #[inline(always)]
    pub(crate) fn gather(
        &self,
        table: &[u64],
        len: usize,
        to: Cell,
        width: u32,
        words: &mut Lanes<u64>,
    ) {
        match table.first_chunk() {
            Some(table) if len <= BYTE => gather_bytes(table, self.byte_offsets(to, width), words),
            _ => gather_words(table, self.offsets(to, width), words),
        }
    }

    #[inline(always)]
    fn offsets(&self, to: Cell, width: u32) -> Lanes<u32> {
        let (x, begin) = (to.x as i32, (to.y * width) as i32);
        let mut index = [0; WIDTH];
        for lane in 0..WIDTH {
            index[lane] =
                (self.begin[lane] - begin).unsigned_abs() + (self.x[lane] - x).unsigned_abs();
        }
        index
    }

    #[inline(always)]
    fn byte_offsets(&self, to: Cell, width: u32) -> Lanes<u8> {
        let (x, begin) = (to.x as u8, (to.y * width) as u8);
        let mut index = [0; WIDTH];
        for lane in 0..WIDTH {
            index[lane] = (self.byte_begin[lane].max(begin) - self.byte_begin[lane].min(begin))
                + (self.byte_x[lane].max(x) - self.byte_x[lane].min(x));
        }
        index
    }
}

/// Keeps the compiler from taking an array apart, which it does where lanes go separate ways afterwards, and then works
/// the array out one lane after the other.
#[inline(always)]
pub(crate) fn in_memory<T>(lanes: &mut T) {
    core::hint::black_box(lanes);
}

/// Up to this many entries, an index is a byte, whose bounds need no check.
const BYTE: usize = 256;

/// The words of a table, `len` entries long, at an index for each lane. What follows the table may be given too.
#[inline(always)]
pub(crate) fn gather(table: &[u64], len: usize, index: &Lanes<u32>) -> Lanes<u64> {
    let mut words = [0; WIDTH];
    match table.first_chunk() {
        Some(table) if len <= BYTE => {
            gather_bytes(table, index.map(|index| index as u8), &mut words)
        }
        _ => gather_words(table, *index, &mut words),
    }
    words
}

#[inline(always)]
fn gather_bytes(table: &[u64; BYTE], mut index: Lanes<u8>, words: &mut Lanes<u64>) {
    in_memory(&mut index);
    for lane in 0..WIDTH {
        words[lane] = table[usize::from(index[lane])];
    }
}

#[inline(always)]
fn gather_words(table: &[u64], mut index: Lanes<u32>, words: &mut Lanes<u64>) {
    in_memory(&mut index);
    for lane in 0..WIDTH {
        words[lane] = table[index[lane] as usize];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn a_fleet_of_any_size_is_read_and_written_whole() {
        for uavs in 1..=70 {
            let row: Vec<u64> = (1..=uavs as u64).collect();
            let mut copy = std::vec![0; uavs];
            let mut visited = 0;
            for block in blocks(uavs) {
                assert_eq!(block.first, visited);
                visited += block.count;
                let lanes = block.load(&row);
                let own = block.lanes().map(|lane| lanes[lane]);
                assert!(own.eq(row[block.first..][..block.count].iter().copied()));
                assert_eq!(
                    block.in_order(&lanes).concat(),
                    row[block.first..][..block.count]
                );
                let mask = spread(block.mask());
                let counted = (0..WIDTH).filter(|&lane| mask[lane] != 0);
                assert!(counted.eq(block.lanes()));
                for (lane, &index) in block.indices().iter().enumerate() {
                    let copy = row.get(block.first + index as usize).copied();
                    assert!(block.count < HALF || copy == Some(lanes[lane]));
                }
                block.store(&lanes, &mut copy);
            }
            assert_eq!((visited, copy), (uavs, row));
        }
    }

    #[test]
    fn words_of_rows_are_those_of_each_uav() {
        for (uavs, len) in [(7, 1), (15, 1), (15, 3), (37, 2)] {
            let rows: Vec<u64> = (0..(uavs * len) as u64).collect();
            let mut copy = std::vec![0; uavs * len];
            for block in blocks(uavs) {
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
    }

    #[test]
    fn bits_of_a_block_leave_the_others_alone() {
        let mut set = [0x0123_4567_89AB_CDEF, 0xFEDC_BA98_7654_3210];
        for block in blocks(100) {
            let before = set;
            let bits = block.bits(&set);
            assert_eq!(gather_bits(&spread(bits)), bits);
            assert_eq!(
                block.uavs_in(bits),
                before[block.first / 64] >> (block.first % 64) & (u64::MAX >> (64 - block.count))
            );
            block.put_bits(!bits, &mut set);
            assert_eq!(block.bits(&set), !bits & block.mask());
            block.put_bits(bits, &mut set);
            assert_eq!(set, before);
        }
    }
}
