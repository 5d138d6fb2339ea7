//! Philox4x32-10 from its publication: J. K. Salmon, M. A. Moraes, R. O. Dror and
//! D. E. Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011.
//!
//! A round multiplies two of the four counter words by constants and keeps both halves of each
//! product. It mixes them with the other two words and the key. Between rounds the Weyl constants
//! are added to the key.

const MULTIPLIER_0: u64 = 0xD251_1F53;
const MULTIPLIER_1: u64 = 0xCD9E_8D57;
const WEYL_0: u32 = 0x9E37_79B9;
const WEYL_1: u32 = 0xBB67_AE85;

/// Applies ten rounds to `counter` with `key`.
pub fn philox4x32_10(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    let [mut c0, mut c1, mut c2, mut c3] = counter;
    let [mut k0, mut k1] = key;
    for round in 0..10 {
        if round > 0 {
            k0 = k0.wrapping_add(WEYL_0);
            k1 = k1.wrapping_add(WEYL_1);
        }
        let product_0 = MULTIPLIER_0 * u64::from(c0);
        let product_1 = MULTIPLIER_1 * u64::from(c2);
        let next_0 = high(product_1) ^ c1 ^ k0;
        let next_1 = low(product_1);
        let next_2 = high(product_0) ^ c3 ^ k1;
        let next_3 = low(product_0);
        (c0, c1, c2, c3) = (next_0, next_1, next_2, next_3);
    }
    [c0, c1, c2, c3]
}

/// Returns one block of the stream of `seed`, whose two halves are the key.
pub fn block(seed: u64, counter: [u32; 4]) -> [u32; 4] {
    philox4x32_10(counter, [low(seed), high(seed)])
}

/// Returns the first two words of a block as one number, low word first.
pub fn first_u64(words: [u32; 4]) -> u64 {
    u64::from(words[0]) + (u64::from(words[1]) << 32)
}

fn low(x: u64) -> u32 {
    (x & 0xFFFF_FFFF) as u32
}

fn high(x: u64) -> u32 {
    (x >> 32) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Catches any error in the rounds by the vectors of Random123's `kat_vectors`.
    #[test]
    fn published_vectors_hold() {
        let zeros = philox4x32_10([0; 4], [0; 2]);
        assert_eq!(zeros, [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);

        let ones = philox4x32_10([u32::MAX; 4], [u32::MAX; 2]);
        assert_eq!(ones, [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]);

        let pi = philox4x32_10(
            [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
            [0xa409_3822, 0x299f_31d0],
        );
        assert_eq!(pi, [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]);
    }
}
