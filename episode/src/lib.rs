//! Runs episodes of jcas and reports on them, without learning:
//!
//! - [`files`]: regular files of bounded size;
//! - [`card`]: trained policies on disk, with their cards;
//! - [`campaign`]: one episode, or a campaign of many on all cores;
//! - [`statistics`]: success, mission time, energy, CO2 and throughput with 95 % intervals;
//! - [`trace`]: an episode on file, verified bit for bit;
//! - [`replay`]: a page that plays such an episode;
//! - [`shard`]: parts of a long computation for several machines.
//!
//! With the feature `parallel` (default) a campaign uses all cores through rayon; results do not
//! depend on the number of cores. Without it everything runs on one thread, on any target that has
//! the standard library.

#![forbid(unsafe_code)]

pub mod campaign;
pub mod card;
pub mod files;
pub mod replay;
pub mod shard;
pub mod statistics;
pub mod trace;
