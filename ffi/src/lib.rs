//! The C ABI of the kernel. `include/jcas.h` is generated from this crate, so the comments of
//! exported items use the terms of C.
//!
//! Exported functions are thin: they check pointers, lengths and handles, then call the safe
//! kernel. Each `unsafe` block says why it is sound.
#![deny(clippy::undocumented_unsafe_blocks)]
// C programmers read the safety conditions in the header's introduction, once.
#![allow(clippy::missing_safety_doc)]
// Exported types carry the names that they have in C.
#![allow(non_camel_case_types)]

// In the order of the header; the blank lines keep it.
mod version;

mod status;

mod config;

mod config_text;

mod records;

mod model;

mod sim;

mod parts;

mod read;

mod snapshot;

mod record;

mod batch;

mod batch_step;

mod policy;

mod policy_memory;

mod plan;

mod batch_fork;

mod batch_rollout;

mod batch_block;
mod batch_buffers;
mod batch_job;
mod handle;
mod in_use;
mod memory;
mod model_block;
#[cfg(all(test, loom))]
mod model_check;
mod names;
mod plan_block;
mod policy_block;
#[cfg(any(kani, all(test, not(loom))))]
mod proofs;
mod recording;
mod rollout_job;
mod scripted;
mod sim_block;
mod sync;
mod thread_pool;
mod timeline;

pub use batch::*;
pub use batch_buffers::{BATCH_OUT_SOURCE, jcas_batch_out};
pub use batch_fork::*;
pub use batch_rollout::*;
pub use batch_step::*;
pub use config::*;
pub use config_text::*;
pub use model::*;
pub use parts::*;
pub use plan::*;
pub use policy::*;
pub use policy_memory::*;
pub use read::*;
pub use record::*;
pub use records::*;
pub use sim::*;
pub use snapshot::*;
pub use status::*;
pub use version::*;
