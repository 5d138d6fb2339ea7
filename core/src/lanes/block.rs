//! A block of UAVs, and how its lanes are loaded from rows and stored into them.

#[cfg(test)]
mod tests;

use core::ops::Range;

use super::Lanes;

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
    uavs.step_by(W).map(move |first| Block::of(first, end))
}

impl<const W: usize> Block<W> {
    /// Number of lanes in the first half; a width of one has no second half.
    const HALF: usize = W.div_ceil(2);
    const FIRST_HALF: u64 = (1 << Self::HALF) - 1;

    /// The block that begins with UAV `first` of the UAVs before `end`.
    // Proof: proofs/fleet.rs, blocks_cover_each_uav_once
    #[inline(always)]
    pub(crate) const fn of(first: usize, end: usize) -> Self {
        // A block of width one is always full, which the compiler does not deduce.
        let count = if W == 1 || end - first >= W {
            W
        } else {
            end - first
        };
        Self { first, count }
    }

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
