//! The command `jcas`, and the options, errors and files that the laboratory's command shares.

#![forbid(unsafe_code)]

mod answering;
mod command_line;
mod commands;
pub mod config_source;
pub mod error;
mod evaluation;
pub mod export;
pub mod fields;
pub mod files;
pub mod idle;
pub mod interrupt;
pub mod learned;
pub mod numbers;
pub mod options;
pub mod planned;
mod progress;
mod radar_table;
mod serve;
pub mod shard;
mod sweep;

pub use commands::Command;
