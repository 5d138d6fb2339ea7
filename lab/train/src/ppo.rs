//! Proximal policy optimisation, one idea a file.

pub mod acting;
pub mod adam;
pub mod gae;
pub mod normalise;
pub mod rollout;
pub mod schedule;
pub mod update;
