//! Training of fleets: PPO with one actor shared by all UAVs and a critic on the global state.
//!
//! Start with [`settings`] for the options of a run and [`trainer`] for one iteration. [`ppo`] has
//! the algorithm; [`network`] and [`head`] have the models.

#![forbid(unsafe_code)]

pub mod checkpoint;
pub mod device;
pub mod draw;
pub mod environment;
pub mod error;
pub mod head;
pub mod metrics;
pub mod network;
pub mod policy;
pub mod ppo;
pub mod random;
pub mod run;
pub mod settings;
pub mod speed;
pub mod store;
pub mod trainer;
