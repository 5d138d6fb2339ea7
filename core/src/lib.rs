//! Deterministic simulation kernel for fleets of UAVs that sense and communicate with one OFDM waveform.
//!
//! A [`Config`] becomes an immutable [`Model`]; a [`Model`] steps states, each one slab of words in the
//! caller's memory. No allocation, no I/O, no clock, no global, no `unsafe`; every loop is bounded by the
//! configuration and every public function returns a value or a typed [`Error`]. With the feature `alloc`,
//! `Sim` keeps a state in memory of its own.
//!
//! ```
//! # #[cfg(feature = "alloc")] {
//! use jcas_core::{Config, Model, Sim};
//!
//! let model = Model::new(Config { uav_count: 5, ..Config::default() })?;
//! let mut sim = Sim::new(&model);
//! sim.reset(42);
//! let outcome = sim.step(&vec![0.0; model.action_len()])?;
//! assert!(!outcome.terminated);
//! # }
//! # Ok::<(), jcas_core::Error>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]
// Index loops over constants are what bounded model checking handles best.
#![allow(clippy::needless_range_loop, clippy::manual_memcpy)]
// Comparisons are spelled out, so that a reader sees what a NaN does and every platform does the same.
#![allow(clippy::manual_clamp, clippy::manual_range_contains)]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod action;
pub mod batch;
pub mod bits;
pub mod carbon;
pub mod config;
mod coverage;
pub mod energy;
pub mod error;
mod graph;
pub mod hash;
pub mod header;
pub mod host;
mod knowledge;
mod lanes;
mod layout;
pub mod link;
mod metrics;
mod model;
pub mod motion;
pub mod observation;
mod potential;
#[cfg(any(kani, test))]
mod proofs;
mod radar;
mod reset;
pub mod reward;
pub mod rng;
mod scratch;
mod search;
mod sensing;
#[cfg(feature = "alloc")]
mod sim;
mod snapshot;
mod state;
mod step;
mod validity;
mod word;

pub use action::Motion;
pub use config::{
    Cell, ChargeBilling, Config, InformPayment, MapDirections, Preset, SearchMaps,
    TargetVisibility, UavTag,
};
pub use error::{ConfigError, Error};
pub use metrics::Metrics;
pub use model::Model;
pub use scratch::Scratch;
#[cfg(feature = "alloc")]
pub use sim::Sim;
pub use state::{StateMut, StateRef};
pub use step::StepOutcome;

/// Version of the kernel; part of every trace.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
