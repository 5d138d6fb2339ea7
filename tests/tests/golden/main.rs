//! Golden traces: episodes that all builds have to reproduce bit for bit.
//!
//! These tests catch any change of the model, its random draws, its rounding or its order of
//! summation. They also catch a change of the observations or of the state's layout. Each trace
//! covers a branch of the step, and its test shows that it reaches that branch. `golden/record.sh`
//! records them.

#[path = "../abi_support/mod.rs"]
mod abi_support;
mod charging;
mod endings;
mod false_alarms;
mod fleets;
mod format;
mod readings;
mod searching;
mod support;
