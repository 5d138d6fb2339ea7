//! FNV-1a, 64 bits: the fingerprint of configurations, states, observations and files.
//!
//! G. Fowler, L. C. Noll, K.-P. Vo, D. Eastlake, "The FNV Non-Cryptographic Hash Algorithm" (IETF
//! draft). It guards against accidents, not against an adversary.

/// An FNV-1a hash in progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fnv1a(u64);

impl Default for Fnv1a {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv1a {
    /// The empty hash.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds bytes.
    pub fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Adds a word, little-endian.
    pub fn write_u64(&mut self, word: u64) {
        self.write(&word.to_le_bytes());
    }

    /// A hash that continues from a value.
    #[cfg(any(kani, test))]
    pub(crate) const fn resumed(value: u64) -> Self {
        Self(value)
    }

    /// The hash of all bytes that were added.
    #[must_use]
    pub fn finish(self) -> u64 {
        self.0
    }
}

/// Hash of words, each little-endian.
#[must_use]
pub fn words(words: &[u64]) -> u64 {
    let mut hash = Fnv1a::new();
    for &word in words {
        hash.write_u64(word);
    }
    hash.finish()
}

/// Hash of observations: the little-endian bytes of each value.
#[must_use]
pub fn reals(values: &[f32]) -> u64 {
    let mut hash = Fnv1a::new();
    for value in values {
        hash.write(&value.to_bits().to_le_bytes());
    }
    hash.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vectors from the FNV draft's test suite.
    #[test]
    fn matches_published_vectors() {
        let of = |text: &str| {
            let mut hash = Fnv1a::new();
            hash.write(text.as_bytes());
            hash.finish()
        };
        assert_eq!(of(""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(of("a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(of("foobar"), 0x8594_4171_f739_67e8);
    }
}
