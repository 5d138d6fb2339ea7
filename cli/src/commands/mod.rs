//! Each command has a file of its own.

mod bench;
mod config;
mod evaluate;
mod merge;
mod plan;
mod play;
mod policies;
mod replay;
pub mod simulate;
mod sweep;
mod tour;
mod trace;

use clap::Subcommand;

use crate::error::{CliError, Outcome};
use crate::idle::Idle;

/// The commands. The doc comment of each variant is its help text.
#[allow(missing_docs)]
#[derive(Subcommand)]
pub enum Command {
    Tour(tour::Tour),
    Simulate(simulate::Simulate),
    Plan(plan::Plan),
    Sweep(sweep::Sweep),
    Merge(merge::Merge),
    Evaluate(evaluate::Evaluate),
    #[command(subcommand)]
    Trace(trace::Trace),
    Replay(replay::Replay),
    Play(play::Play),
    Policies(policies::Policies),
    #[command(subcommand)]
    Config(config::ConfigCommand),
    Bench(bench::Bench),
}

impl Command {
    /// The options that would have no effect with the values of the others.
    #[must_use]
    pub fn idle(&self) -> Vec<Idle> {
        match self {
            Self::Simulate(command) => command.idle(),
            Self::Plan(command) => command.idle(),
            Self::Evaluate(command) => command.idle(),
            Self::Trace(command) => command.idle(),
            Self::Replay(command) => command.idle(),
            Self::Tour(_)
            | Self::Sweep(_)
            | Self::Merge(_)
            | Self::Play(_)
            | Self::Policies(_)
            | Self::Config(_)
            | Self::Bench(_) => Vec::new(),
        }
    }

    /// Runs the command.
    pub fn run(self) -> Result<Outcome, CliError> {
        match self {
            Self::Tour(command) => command.run(),
            Self::Simulate(command) => command.run(),
            Self::Plan(command) => command.run(),
            Self::Sweep(command) => command.run(),
            Self::Merge(command) => command.run(),
            Self::Evaluate(command) => command.run(),
            Self::Trace(command) => command.run(),
            Self::Replay(command) => command.run(),
            Self::Play(command) => command.run(),
            Self::Policies(command) => command.run(),
            Self::Config(command) => command.run(),
            Self::Bench(command) => command.run(),
        }
    }
}
