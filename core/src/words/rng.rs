//! Counter-based random draws: Philox4x32-10.
//!
//! J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, "Parallel random numbers: as easy as 1, 2,
//! 3", SC 2011. Every draw is a pure function of (seed, step, UAV, item, purpose): none depends on
//! another having been made, nor on order, batch or thread.

const MULTIPLIER_0: u32 = 0xD251_1F53;
const MULTIPLIER_1: u32 = 0xCD9E_8D57;
/// Weyl constants that bump the key between rounds: the golden ratio and sqrt(3) - 1.
const WEYL_0: u32 = 0x9E37_79B9;
const WEYL_1: u32 = 0xBB67_AE85;

/// One Philox block: four words, which are a bijection of the counter for each key.
#[inline(always)]
#[must_use]
pub fn philox4x32_10(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    let mut round = 0;
    while round < 10 {
        let low = u64::from(counter[0]) * u64::from(MULTIPLIER_0);
        let high = u64::from(counter[2]) * u64::from(MULTIPLIER_1);
        counter = [
            (high >> 32) as u32 ^ counter[1] ^ key[0],
            high as u32,
            (low >> 32) as u32 ^ counter[3] ^ key[1],
            low as u32,
        ];
        key = [key[0].wrapping_add(WEYL_0), key[1].wrapping_add(WEYL_1)];
        round += 1;
    }
    counter
}

/// Purpose of a draw. It is the fourth word of the counter, so that no two purposes share a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Purpose {
    /// Whether a UAV detects a hotspot in a step.
    Detect = 1,
    /// Carbon intensity of the next step.
    Carbon = 2,
    /// Initial state of charge of a UAV.
    InitialSoc = 3,
    /// The cells of the hotspots.
    Hotspot = 4,
    /// The order of the hotspots.
    Shuffle = 5,
    /// Seeds derived from a seed: batch members, later episodes.
    Seed = 6,
    /// Draws of policies.
    Policy = 7,
    /// The false alarms of a UAV in a step.
    FalseAlarm = 8,
    /// The cell in which a UAV starts.
    StartCell = 9,
}

/// The counter of a block. It is injective, because each argument has its own word.
#[inline(always)]
#[must_use]
pub const fn counter(step: u32, uav: u32, block: u32, purpose: Purpose) -> [u32; 4] {
    [step, uav, block, purpose as u32]
}

/// The Philox block of a draw.
#[inline(always)]
#[must_use]
pub fn block(seed: u64, step: u32, uav: u32, block: u32, purpose: Purpose) -> [u32; 4] {
    philox4x32_10(
        counter(step, uav, block, purpose),
        [seed as u32, (seed >> 32) as u32],
    )
}

/// The blocks of some UAVs: word by word, each a lane for each UAV.
#[inline(always)]
#[must_use]
pub(crate) fn blocks<const W: usize>(
    seed: u64,
    step: u32,
    uavs: &[u32; W],
    index: u32,
    purpose: Purpose,
) -> [[u32; W]; 4] {
    let mut words = [[0; W]; 4];
    let [first, second, third, fourth] = &mut words;
    for lane in 0..W {
        let one = block(seed, step, uavs[lane], index, purpose);
        first[lane] = one[0];
        second[lane] = one[1];
        third[lane] = one[2];
        fourth[lane] = one[3];
    }
    words
}

/// 64 uniform bits: words 0 (low) and 1 (high) of the block.
#[inline]
#[must_use]
pub fn bits64(seed: u64, step: u32, uav: u32, index: u32, purpose: Purpose) -> u64 {
    let words = block(seed, step, uav, index, purpose);
    u64::from(words[0]) | u64::from(words[1]) << 32
}

/// A uniform integer in `0..count` from 64 uniform bits; 0 for an empty range.
///
/// It multiplies and shifts without rejection, so that no loop is needed. Each value's probability
/// deviates by less than `count / 2^64`.
#[inline]
#[must_use]
pub fn below(bits: u64, count: u64) -> u64 {
    ((u128::from(bits) * u128::from(count)) >> 64) as u64
}

/// A uniform real in [0, 1): the upper 53 bits, each value a multiple of 2^-53.
#[inline]
#[must_use]
pub fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
}

/// Derives the seed with this index from `seed`, for members of a batch and later episodes.
#[must_use]
pub fn derive_seed(seed: u64, index: u64) -> u64 {
    bits64(seed, index as u32, (index >> 32) as u32, 0, Purpose::Seed)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known-answer vectors of the Random123 distribution (`kat_vectors`, philox4x32 with 10
    /// rounds).
    #[test]
    fn matches_the_published_vectors() {
        assert_eq!(
            philox4x32_10([0; 4], [0; 2]),
            [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]
        );
        assert_eq!(
            philox4x32_10([u32::MAX; 4], [u32::MAX; 2]),
            [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]
        );
        assert_eq!(
            philox4x32_10(
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0]
            ),
            [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]
        );
    }

    #[test]
    fn blocks_side_by_side_are_those_one_by_one() {
        for (seed, step, uav, index) in
            [(0, 1, 0, 0), (u64::MAX, 99, 4080, 17), (1 << 40, 7, 16, 3)]
        {
            let uavs: [u32; 16] = core::array::from_fn(|lane| uav + (lane as u32 * 7) % 16);
            let rows = blocks(seed, step, &uavs, index, Purpose::Detect);
            for (lane, &uav) in uavs.iter().enumerate() {
                let one = block(seed, step, uav, index, Purpose::Detect);
                assert_eq!(rows.map(|row| row[lane]), one);
            }
        }
    }

    #[test]
    fn uniform_draws_stay_in_range() {
        assert_eq!(below(u64::MAX, 7), 6);
        assert_eq!(below(0, 7), 0);
        assert_eq!(below(u64::MAX, 0), 0);
        assert_eq!(unit(0), 0.0);
        assert!(unit(u64::MAX) < 1.0);
    }
}
