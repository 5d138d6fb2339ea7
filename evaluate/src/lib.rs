//! Everything around the kernel that flies missions and reports on them, without learning:
//!
//! - [`policy`]: what chooses actions, and the baselines (the crate `jcas-policy`);
//! - [`card`]: trained policies on disk, with their cards;
//! - [`mission`]: one episode, or many over all cores;
//! - [`statistics`]: success, mission time, energy, CO2 and throughput with 95 % intervals;
//! - [`trace`]: an episode on file, verified bit for bit;
//! - [`replay`]: a page that plays such an episode;
//! - `figures`: figures and reports (feature `figures`).
//!
//! With the feature `parallel` (default) campaigns use all cores through rayon; results do not depend
//! on how many there are. Without default features everything
//! runs on one thread and on any target that has the standard library.

#![forbid(unsafe_code)]

pub mod card;
#[cfg(feature = "figures")]
pub mod figures;
pub mod mission;
pub mod replay;
pub mod statistics;
pub mod trace;

pub use jcas_policy as policy;
