//! Checks of the kernel against an independent specification.
//!
//! [`specification`] is the model written a second time, as plainly as possible. [`sampling`] draws
//! configurations and actions that reach its corner cases. [`comparison`] finds differences between
//! a state of the kernel and the specification's world. [`mission`] runs whole episodes in both,
//! and [`machine`] makes random sequences of every public call. `proofs.toml` beside this crate's
//! sources lists what Kani proves. `ASSUMPTIONS.md` lists what those proofs assume.

// The specification indexes as its equations do.
#![allow(clippy::needless_range_loop)]

pub mod comparison;
pub mod machine;
pub mod mission;
#[cfg(any(kani, test))]
mod proofs;
pub mod sampling;
pub mod specification;
