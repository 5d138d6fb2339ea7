//! The proofs of the checks that every file of a policy, and every weight, passes.
//!
//! They are built as the kernel's are, and run without Kani through the same stand-in.

// These two modules belong to the kernel's proofs, which use all their parts.
#[allow(dead_code)]
#[path = "../../../core/src/proofs/inputs.rs"]
pub(crate) mod inputs;
#[cfg(not(kani))]
#[allow(dead_code)]
#[path = "../../../core/src/proofs/standin.rs"]
pub(crate) mod standin;

mod arrays;
mod header;
mod weights;
