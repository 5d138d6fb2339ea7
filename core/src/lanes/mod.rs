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
const HALF: usize = WIDTH / 2;

/// Fleets from this size on fly in lanes: for fewer, one UAV after the other costs less.
pub(crate) const FLEET: usize = HALF;

/// A value for each UAV of a block.
pub(crate) type Lanes<T> = [T; WIDTH];

/// The UAVs `first..first + count`.
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
    /// The block's part of a row with an entry for each UAV; lanes without a UAV hold `T::default()`.
    #[inline(always)]
    pub(crate) fn load<T: Copy + Default>(self, row: &[T]) -> Lanes<T> {
        let mut lanes = [T::default(); WIDTH];
        copy(
            &mut lanes[..self.count],
            &row[self.first..self.first + self.count],
        );
        lanes
    }

    /// Writes the lanes that have a UAV.
    #[inline(always)]
    pub(crate) fn store<T: Copy>(self, lanes: &Lanes<T>, row: &mut [T]) {
        copy(
            &mut row[self.first..self.first + self.count],
            &lanes[..self.count],
        );
    }

    /// Word `word` of the row of bits that each UAV has in `rows`, rows being `len` words long.
    #[inline(always)]
    pub(crate) fn load_word(self, rows: &[u64], len: usize, word: usize) -> Lanes<u64> {
        if len == 1 {
            return self.load(rows);
        }
        let mut lanes = [0; WIDTH];
        let rows = rows[self.first * len..].chunks_exact(len);
        for (lane, row) in lanes[..self.count].iter_mut().zip(rows) {
            *lane = row[word];
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
        for (&lane, row) in lanes[..self.count].iter().zip(rows) {
            row[word] = lane;
        }
    }

    /// The block's bits of a set of UAVs, from bit 0 on. A block never straddles two words.
    #[inline(always)]
    pub(crate) fn bits(self, set: &[u64]) -> u64 {
        set[self.first / 64] >> (self.first % 64) & self.mask()
    }

    /// Writes the block's bits of a set of UAVs.
    #[inline(always)]
    pub(crate) fn put_bits(self, bits: u64, set: &mut [u64]) {
        let (word, shift) = (self.first / 64, self.first % 64);
        set[word] = set[word] & !(self.mask() << shift) | (bits & self.mask()) << shift;
    }

    /// The block's lanes that have a UAV.
    #[inline(always)]
    pub(crate) fn mask(self) -> u64 {
        u64::MAX >> (64 - self.count)
    }
}

/// Copies up to a block. A length between half a block and a whole is two copies of half a block that overlap, which are
/// a few instructions where a copy of any length is a call.
#[inline(always)]
fn copy<T: Copy>(to: &mut [T], from: &[T]) {
    let len = from.len();
    if len == WIDTH {
        to[..WIDTH].copy_from_slice(&from[..WIDTH]);
    } else if len >= HALF {
        to[..HALF].copy_from_slice(&from[..HALF]);
        to[len - HALF..][..HALF].copy_from_slice(&from[len - HALF..][..HALF]);
    } else {
        for index in 0..len {
            to[index] = from[index];
        }
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
        lanes[lane] = 0u64.wrapping_sub(bits >> lane & 1);
    }
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

/// The set of lanes that are not 0.
#[inline(always)]
pub(crate) fn gather_bits(lanes: &Lanes<u64>) -> u64 {
    let mut set = [0u32; WIDTH];
    for lane in 0..WIDTH {
        set[lane] = if lanes[lane] == 0 { 0 } else { 1 << lane };
    }
    in_memory(&mut set);
    let mut bits = 0;
    for lane in 0..WIDTH {
        bits |= set[lane];
    }
    u64::from(bits)
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

    /// Where the rows of a grid begin that the cells are in.
    #[inline(always)]
    pub(crate) fn rows(&self, width: u32) -> Rows {
        let mut begin = [0; WIDTH];
        for lane in 0..WIDTH {
            begin[lane] = self.y[lane] * width as i32;
        }
        in_memory(&mut begin);
        Rows { x: self.x, begin }
    }
}

/// The cells of a block in a grid, row by row.
#[derive(Clone, Copy)]
pub(crate) struct Rows {
    x: Lanes<i32>,
    begin: Lanes<i32>,
}

impl Rows {
    /// Row-major index of the absolute offset to a cell of the grid.
    #[inline(always)]
    pub(crate) fn offsets(&self, to: Cell, width: u32) -> Lanes<u32> {
        let (x, begin) = (to.x as i32, (to.y * width) as i32);
        let mut index = [0; WIDTH];
        for lane in 0..WIDTH {
            index[lane] =
                (self.begin[lane] - begin).unsigned_abs() + (self.x[lane] - x).unsigned_abs();
        }
        index
    }
}

/// Keeps the compiler from taking an array apart, which it does where lanes go separate ways afterwards, and then works
/// the array out one lane after the other.
#[inline(always)]
pub(crate) fn in_memory<T, const N: usize>(lanes: &mut [T; N]) {
    core::hint::black_box(lanes);
}

/// Up to this many entries, an index is a byte, whose bounds need no check.
const BYTE: usize = 256;

/// The words of a table, `len` entries long, at an index for each lane. What follows the table may be given too.
#[inline(always)]
pub(crate) fn gather(table: &[u64], len: usize, index: &Lanes<u32>) -> Lanes<u64> {
    let mut words = [0; WIDTH];
    match table.first_chunk::<BYTE>() {
        Some(table) if len <= BYTE => {
            let mut index = index.map(|index| index as u8);
            in_memory(&mut index);
            for lane in 0..WIDTH {
                words[lane] = table[usize::from(index[lane])];
            }
        }
        _ => {
            let mut index = *index;
            in_memory(&mut index);
            for lane in 0..WIDTH {
                words[lane] = table[index[lane] as usize];
            }
        }
    }
    words
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
                assert!(lanes[block.count..].iter().all(|&lane| lane == 0));
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
                    for lane in 0..block.count {
                        assert_eq!(lanes[lane], rows[(block.first + lane) * len + word]);
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
            block.put_bits(!bits, &mut set);
            assert_eq!(block.bits(&set), !bits & (u64::MAX >> (64 - block.count)));
            block.put_bits(bits, &mut set);
            assert_eq!(set, before);
        }
    }
}
