//! Random numbers of the annealing: a counter-based stream.

use jcas_core::rng::{self, Purpose};

pub(crate) struct Draws {
    seed: u64,
    blocks: u64,
    words: [u32; 4],
    left: usize,
}

impl Draws {
    pub(crate) fn new(seed: u64) -> Self {
        Self {
            seed,
            blocks: 0,
            words: [0; 4],
            left: 0,
        }
    }

    fn word(&mut self) -> u32 {
        if self.left == 0 {
            let (low, high) = (self.blocks as u32, (self.blocks >> 32) as u32);
            self.words = rng::block(self.seed, low, high, 0, Purpose::Policy);
            self.blocks += 1;
            self.left = 4;
        }
        self.left -= 1;
        self.words[self.left]
    }

    /// Draws a uniform integer in `0..count`; 0 for an empty range.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((u64::from(self.word()) * count as u64) >> 32) as usize
    }

    /// Draws a uniform number in (0, 1].
    pub(crate) fn unit(&mut self) -> f64 {
        (f64::from(self.word()) + 1.0) / 4_294_967_296.0
    }
}
