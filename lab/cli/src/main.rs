//! The command `jcas-lab`.

mod commands;
mod manifest;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use commands::{merge, reproduce, train};

/// Keeps the large blocks that training frees and asks for again in every minibatch.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// The laboratory of jcas: train policies, reproduce the paper's results.
#[derive(Parser)]
#[command(
    name = "jcas-lab",
    version,
    after_help = jcas_cli::error::EXIT_CODES,
    propagate_version = true
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Train(train::Train),
    Reproduce(reproduce::Reproduce),
    Merge(merge::Merge),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    jcas_cli::interrupt::listen();
    jcas_cli::error::exit_code(match cli.command {
        Command::Train(command) => command.run(),
        Command::Reproduce(command) => command.run(),
        Command::Merge(command) => command.run(),
    })
}
