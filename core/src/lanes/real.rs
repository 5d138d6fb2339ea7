//! Functions of reals without branches or conversions, which the compiler can vectorise.

use super::{CacheAligned, force_vector};

/// Number of entries of observations that are computed together, for a fleet of any size.
pub(crate) const ENTRIES: usize = 16;

/// Repeats four entries.
#[inline(always)]
pub(crate) fn repeat(four: [f32; 4]) -> [f32; ENTRIES] {
    let mut entries = [0.0; ENTRIES];
    for index in 0..ENTRIES {
        entries[index] = four[index % 4];
    }
    entries
}

/// 2^52: added to a real from 0 to 2^51, it leaves the nearest whole number in the low bits.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// The largest whole number not above a real from 0 to 2^51.
#[inline(always)]
fn floor(value: f64) -> f64 {
    let nearest = (value + WHOLE) - WHOLE;
    if nearest > value {
        nearest - 1.0
    } else {
        nearest
    }
}

/// `value as u64`, for a real from 0 to 2^51.
#[inline(always)]
pub(crate) fn floor_to_u64(value: f64) -> u64 {
    (floor(value) + WHOLE).to_bits() ^ WHOLE.to_bits()
}

/// Four whole numbers from 1 to 1023, over and over, to divide by.
pub(crate) struct Divisors {
    /// The upper fourteen bits of their inverses, and the rest.
    high: CacheAligned<[f32; ENTRIES]>,
    low: CacheAligned<[f32; ENTRIES]>,
}

impl Divisors {
    #[inline(always)]
    pub(crate) fn of(wholes: [f32; 4]) -> Self {
        let inverses = wholes.map(|whole| 1.0 / f64::from(whole));
        let high = inverses.map(|inverse| f32::from_bits((inverse as f32).to_bits() & !0x3FF));
        let mut low = [0.0; 4];
        for entry in 0..4 {
            low[entry] = (inverses[entry] - f64::from(high[entry])) as f32;
        }
        let (mut high, mut low) = (CacheAligned(repeat(high)), CacheAligned(repeat(low)));
        // What is known of the numbers would be put to use for single lanes, and cost more than it
        // saves.
        force_vector(&mut high.0);
        force_vector(&mut low.0);
        Self { high, low }
    }

    /// `(to - from) / divisor` to the last bit, without a division, for whole numbers whose
    /// difference is from -1023 to 1023. The first product is exact, and the second is so small
    /// that its rounding does not change the sum.
    #[inline(always)]
    pub(crate) fn offset(&self, from: f32, to: f32, entry: usize) -> f32 {
        let offset = to - from;
        offset * self.high.0[entry] + offset * self.low.0[entry]
    }
}

// These constants are those of libm's `exp` (FreeBSD's `e_exp.c`).
const LN2_HIGH: f64 = 6.931_471_803_691_238e-1;
const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
const PER_LN2: f64 = core::f64::consts::LOG2_E;
const P1: f64 = 1.666_666_666_666_660_2e-1;
const P2: f64 = -2.777_777_777_701_559_3e-3;
const P3: f64 = 6.613_756_321_437_934e-5;
const P4: f64 = -1.653_390_220_546_525_2e-6;
const P5: f64 = 4.138_136_797_057_238_5e-8;
/// Thresholds 2^-28, ln(2)/2 and 3 ln(2)/2 at which `exp` changes its branch. It compares the upper
/// word only.
const TINY: f64 = f64::from_bits(0x3e30_0001_0000_0000);
const HALF_LN2: f64 = f64::from_bits(0x3fd6_2e43_0000_0000);
const THREE_HALVES_LN2: f64 = f64::from_bits(0x3ff0_a2b2_0000_0000);

/// `libm::exp` for arguments from 0 to 700, to the last bit. It does the same operations in the
/// same order, computes every branch and selects one.
#[inline(always)]
pub(crate) fn exp(x: f64) -> f64 {
    let whole = floor(PER_LN2 * x + 0.5);
    let k = if x >= THREE_HALVES_LN2 {
        whole
    } else if x >= HALF_LN2 {
        1.0
    } else {
        0.0
    };
    let (high, low) = (x - k * LN2_HIGH, k * LN2_LOW);
    let r = high - low;
    let rr = r * r;
    let c = r - rr * (P1 + rr * (P2 + rr * (P3 + rr * (P4 + rr * P5))));
    let y = 1.0 + (r * c / (2.0 - c) - low + high);
    // The low bits of this sum are k + 1023, the exponent of 2^k.
    let power = f64::from_bits((k + (WHOLE + 1023.0)).to_bits() << 52);
    if x >= TINY { y * power } else { 1.0 + x }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn same(x: f64) {
        assert_eq!(exp(x).to_bits(), libm::exp(x).to_bits(), "{x:e}");
    }

    #[test]
    fn is_libms_to_the_last_bit() {
        for step in 0..=700_000 {
            same(f64::from(step) * 1e-3);
        }
        for step in 0..400_000u64 {
            // Every exponent from 2^-1022 on, mantissas as they fall.
            let bits = step.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 2;
            let x = f64::from_bits(bits);
            if x <= 700.0 {
                same(x);
            }
        }
    }

    #[test]
    fn changes_its_way_where_libm_does() {
        let half_ln2 = core::f64::consts::LN_2 / 2.0;
        for centre in [TINY, HALF_LN2, THREE_HALVES_LN2, half_ln2, 3.0 * half_ln2] {
            for step in 0..20_000u64 {
                same(f64::from_bits(centre.to_bits() - 10_000 + step));
            }
            for step in 0..20_000u64 {
                same(f64::from_bits(
                    centre.to_bits() - (10_000 << 20) + (step << 20),
                ));
            }
        }
        // Where the quotient is next to a whole number.
        for k in 1..=1009 {
            let centre = (f64::from(k) - 0.5) * core::f64::consts::LN_2;
            for step in 0..64u64 {
                let x = f64::from_bits(centre.to_bits() - 32 + step);
                if x <= 700.0 {
                    same(x);
                }
            }
        }
    }

    #[test]
    fn whole_is_the_conversion() {
        for step in 0..400_000u64 {
            let bits = step.wrapping_mul(0x9E37_79B9_7F4A_7C15);
            for value in [
                (bits >> 20) as f64 / 1024.0,
                (bits >> 13) as f64,
                (bits >> 14) as f64 + 0.5,
                (bits >> 40) as f64 / 3.0,
            ] {
                assert_eq!(floor_to_u64(value), value as u64, "{value}");
            }
        }
        for value in [0.0, 0.5, 1.0 - f64::EPSILON / 2.0, 1.0, 1.5, 2.5] {
            assert_eq!(floor_to_u64(value), value as u64, "{value}");
        }
    }

    #[test]
    fn offsets_are_divided() {
        for divisor in 1..1024u16 {
            let divisors = Divisors::of([f32::from(divisor); 4]);
            for x in -1023..1024i16 {
                let divided = f32::from(x) / f32::from(divisor);
                let offset = divisors.offset(512.0, 512.0 + f32::from(x), 0);
                assert_eq!(offset.to_bits(), divided.to_bits(), "{x} / {divisor}");
            }
        }
    }

    #[test]
    fn of_nothing_is_one() {
        same(0.0);
        same(f64::MIN_POSITIVE);
        same(700.0);
    }
}
