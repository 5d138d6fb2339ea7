//! Training of fleets: PPO with one actor shared by all UAVs and a critic on the global state.
//!
//! Reads from the outside in: [`settings`] says what a run is told, [`trainer`] what an iteration
//! does, [`ppo`] how it learns, [`network`] and [`head`] what is learnt.

#![forbid(unsafe_code)]

pub mod checkpoint;
pub mod device;
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
