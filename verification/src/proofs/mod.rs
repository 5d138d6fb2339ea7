//! Proofs that need the kernel and the specification at once.

#[path = "../../../core/src/proofs/inputs.rs"]
#[allow(dead_code)]
pub(crate) mod inputs;
#[cfg(not(kani))]
#[path = "../../../core/src/proofs/standin.rs"]
#[allow(dead_code)]
pub(crate) mod standin;

mod equivalence;
