//! The command `jcas`.

mod commands;
mod config_source;
mod error;
mod files;
mod interrupt;
mod learned;
mod options;
mod progress;
mod serve;
mod sweep;

use std::process::ExitCode;

use clap::Parser;
use commands::Command;
use error::{EXIT_DIFFERENT, Outcome};

/// Keeps the large blocks that training frees and asks for again in every minibatch.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    a verification or comparison found a difference
  2    something given is not acceptable: an option, a field, the content of a file
  3    a file could not be read or written
  130  stopped by Ctrl-C

Examples:
  jcas sweep                             fly the paper's grid; table, figures and replay in out/
  jcas simulate --uavs 15 --hotspots 7   one cell of it
  jcas play                              fly missions in a browser and change them as they fly
  jcas replay -o page.html               watch an episode in a browser
  jcas config show                       every field with its unit and legal range";

/// Fleets of UAVs that sense and communicate with one OFDM waveform: fly them, sweep over fleets and
/// settings, record and verify episodes, watch them.
#[derive(Parser)]
#[command(name = "jcas", version, after_help = EXIT_CODES, propagate_version = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    interrupt::listen();
    match cli.command.run() {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Different) => ExitCode::from(EXIT_DIFFERENT),
        Err(error) => {
            eprintln!("error: {error}");
            error.exit_code()
        }
    }
}
