//! What the kernel is held against.
//!
//! [`specification`] is the model a second time, as plainly as it can be written.
//! [`sampling`] draws configurations and actions that reach its corners;
//! [`comparison`] says where a state of the kernel differs from the specification's
//! world; [`mission`] flies whole episodes in both, [`machine`] makes random sequences
//! of every public call. `proofs.toml` beside this crate's sources lists what Kani proves, and
//! `ASSUMPTIONS.md` what those proofs rest on.

// The specification indexes as its equations do.
#![allow(clippy::needless_range_loop)]

pub mod comparison;
pub mod machine;
pub mod mission;
#[cfg(any(kani, test))]
mod proofs;
pub mod sampling;
pub mod specification;
