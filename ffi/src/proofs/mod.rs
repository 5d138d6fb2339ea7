//! The proofs of the gates through which every pointer, length and handle of a C caller passes.
//!
//! They are built like the kernel's proofs, and run without Kani through the same stand-in.

// The file is shared with the kernel's proofs, which use every item.
#[allow(dead_code)]
#[path = "../../../core/src/proofs/inputs.rs"]
pub(crate) mod inputs;
#[cfg(not(kani))]
#[allow(dead_code)]
#[path = "../../../core/src/proofs/standin.rs"]
pub(crate) mod standin;

mod gates;
