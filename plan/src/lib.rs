//! Plans of episodes: a trajectory for each UAV, chosen for the least expected time to the end.
//!
//! A plan is followed without feedback until every hotspot is confirmed. The fleet then gathers
//! until it is one radio component, which ends the episode. [`expect`] gives the expected time of a
//! plan exactly, from the tables of the [`Model`](jcas_core::Model). [`search`] and [`tour`] look
//! for a plan of short expected time by simulated annealing. No fixed plan can beat [`bound`].
//!
//! A result is a function of configuration, seed and number of iterations. The crate reads no
//! clock. A caller with a time limit ends the annealing from its progress callback; the best plan
//! found by then is returned.
//!
//! [`Planned`] is the policy that follows plans, and [`PlannedKind`] names those that make them.
//! The feature `file` reads and writes plans as JSON (`PlanFile`).
//!
//! ```
//! use core::ops::ControlFlow;
//! use jcas_core::{Config, Model, Preset};
//! use jcas_plan::{Settings, search};
//!
//! let model = Model::new(Config::preset(Preset::Search))?;
//! let settings = Settings { iterations: 2_000, ..Settings::default() };
//! let plan = search(&model, &settings, &mut |_| ControlFlow::Continue(()))?;
//! assert!(plan.bound_steps <= plan.expected.steps);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]
// Loops over the lanes of several rows at once.
#![allow(clippy::needless_range_loop)]

extern crate alloc;
#[cfg(test)]
extern crate std;

mod alone;
mod anneal;
mod battery;
mod belief;
mod bound;
mod draws;
mod error;
#[cfg(feature = "file")]
mod file;
mod follow;
mod formation;
mod gather;
mod gossip;
mod memory;
mod objective;
mod odds;
mod paths;
mod plan;
mod planned;
mod problem;
mod replan;
mod rounds;
mod routes;
mod targets;
mod teams;
mod view;
mod watch;

pub use anneal::{Annealer, Progress, Settings};
pub use battery::allows;
pub use bound::bound;
pub use error::PlanError;
#[cfg(feature = "file")]
pub use file::{FORMAT, PlanFile, PlanFileError, READ_BYTES_MAX, Trajectory};
pub use follow::Follower;
pub use memory::{check_available, memory_bound};
pub use objective::{Expectation, expect};
pub use odds::Odds;
pub use paths::Paths;
pub use plan::{Plan, improve, search, starts, tour};
pub use planned::{
    Planned, PlannedKind, REPLAN_ITERATIONS, REPORT_ITERATIONS, SEARCH_ITERATIONS, TOUR_ITERATIONS,
};
pub use problem::{Problem, Situation};
pub use replan::Replanner;
pub use targets::{Group, Placement, Targets};
