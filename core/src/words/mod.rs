//! Words, bits, hashes, draws and cells: the vocabulary of all other rooms, of which it uses none.

pub mod bits;
pub(crate) mod geometry;
pub mod hash;
pub(crate) mod printable;
pub mod rng;
pub(crate) mod units;
pub(crate) mod word;
