//! Missions over a grid of settings: which cells there are, what is known of each, how they look.

pub mod charts;
pub mod plan;
pub mod store;
