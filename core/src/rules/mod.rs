//! The rules of a step, one a file: each reads and writes a state, and [`crate::step`] orders them.

pub mod action;
pub(crate) mod alarms;
pub mod carbon;
pub(crate) mod coverage;
pub mod energy;
pub(crate) mod graph;
pub(crate) mod knowledge;
pub(crate) mod metrics;
pub mod motion;
pub(crate) mod potential;
pub(crate) mod reports;
pub(crate) mod reset;
pub mod reward;
pub(crate) mod sensing;
