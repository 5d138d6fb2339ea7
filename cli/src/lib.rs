//! The command `jcas`, and what the laboratory's command shares with it: options, errors, files.

#![forbid(unsafe_code)]

mod commands;
pub mod config_source;
pub mod error;
pub mod export;
pub mod files;
pub mod interrupt;
pub mod learned;
pub mod options;
pub mod planned;
mod progress;
mod serve;
mod sweep;

pub use commands::Command;
