//! Deterministic simulation kernel for fleets of UAVs that sense and communicate with one OFDM
//! waveform.
//!
//! A [`Config`] is validated into an immutable [`Model`]. A [`Model`] steps states, each of which
//! is one slab of `u64` words in the caller's memory. The kernel does no allocation and no I/O, and
//! it has no clock, no global variable and no `unsafe` code. The configuration bounds every loop,
//! and every public function returns a value or a typed [`Error`]. With the feature `alloc`, `Sim`
//! owns the memory of its state.
//!
//! In the documentation N is the number of UAVs and n the number of hotspots. W and H are the width
//! and height of the grid in cells, and t is the number of steps begun since the reset.
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
// Bounded model checking handles index loops over constants best.
#![allow(clippy::needless_range_loop, clippy::manual_memcpy)]
// Explicit comparisons show what a NaN does, and they do the same on every platform.
#![allow(clippy::manual_clamp, clippy::manual_range_contains)]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(test)]
extern crate std;

// The rooms in the order of their imports: each uses those above it.
pub mod error;
mod words;

mod lanes;

pub mod config;

mod radio;

mod constants;

mod model;

mod state;

mod rules;

pub mod observation;

mod step;

pub mod batch;
pub mod host;
mod snapshot;

#[cfg(feature = "alloc")]
mod sim;

#[cfg(any(kani, test))]
mod proofs;

pub use config::{
    Cell, ChargeBilling, Config, DetectionCurve, InformPayment, LearnedDetections, MapDirections,
    MotionMap, PilotGain, Preset, QuorumWindow, SearchMaps, StartCells, TargetVisibility, UavTag,
};
pub use error::{ConfigError, Error};
pub use model::Model;
pub use radio::link;
pub use rules::action::Motion;
pub use rules::metrics::Metrics;
pub use rules::{action, carbon, energy, motion, reward};
#[cfg(feature = "alloc")]
pub use sim::Sim;
pub use state::scratch::Scratch;
pub use state::{StateMut, StateRef, header};
pub use step::StepOutcome;
pub use words::printable::Printable;
pub use words::{bits, hash, rng};

/// Version of the kernel, which every trace records.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
