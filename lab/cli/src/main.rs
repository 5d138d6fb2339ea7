//! The command `jcas-lab`.

mod commands;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use commands::train;

/// Keeps the large blocks that training frees and asks for again in every minibatch.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// The laboratory of jcas: train policies.
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
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    jcas_cli::interrupt::listen();
    jcas_cli::error::exit_code(match cli.command {
        Command::Train(command) => command.run(),
    })
}
