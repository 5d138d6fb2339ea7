//! Random numbers of the learner: stateless streams, so that a resumed run draws the same ones.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The generator named by (`seed`, `index`): the same pair always gives the same numbers.
///
/// ChaCha's own stream number carries the index, so streams of one seed never overlap.
pub fn stream(seed: u64, index: u64) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(index);
    random
}

/// What a stream is used for; keeps the indices of different uses apart.
#[derive(Clone, Copy)]
#[repr(u8)]
pub enum Purpose {
    /// Initial network weights.
    Weights = 1,
    /// Sampled actions.
    Actions = 2,
    /// Order of the minibatches.
    Minibatches = 3,
    /// Configurations that a run trains on.
    Configurations = 4,
}

/// Stream for a use inside an iteration: `a` < 2^32 (iteration), `b` < 2^24 (worker, epoch).
pub fn stream_for(seed: u64, purpose: Purpose, a: u64, b: u64) -> ChaCha8Rng {
    stream(
        seed,
        (purpose as u64) << 56 | (a & 0xffff_ffff) << 24 | (b & 0xff_ffff),
    )
}
