//! The proofs of the gates through which every file of a policy passes, and every weight.
//!
//! They are built as the kernel's are, and run without Kani through the same stand-in.

// Shared with the kernel's proofs, which use all of it.
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
