//! The command `jcas`.

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser};
use jcas_cli::{Command, error, idle, interrupt, numbers};

const EXAMPLES: &str = "\
Examples:
  jcas tour                              fly policies over the paper's grid; report in out/tour/
  jcas sweep                             fly many fleets; table, figures and replay in out/
  jcas simulate --uavs 15 --hotspots 7   many episodes of one fleet
  jcas play                              fly episodes in a browser and change them as they fly
  jcas replay -o page.html               watch an episode in a browser
  jcas config show                       every field with its unit and legal range";

/// Simulate fleets of UAVs that sense and communicate with one OFDM waveform. Sweep over fleets and
/// settings, record and verify episodes, play them back.
#[derive(Parser)]
#[command(
    name = "jcas",
    version,
    after_help = format!("{}\n\n{EXAMPLES}", error::EXIT_CODES),
    propagate_version = true
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    let matches = numbers::accept_negative(Cli::command()).get_matches();
    let Cli { command } = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    interrupt::listen();
    error::exit_code(idle::refuse(&matches, &command.idle()).and_then(|()| command.run()))
}
