//! Development tasks of jcas: `cargo xtask <task>`.

mod kani_output;
mod ledger;
mod mutants;
mod process;
mod prove;
mod report;

use std::process::ExitCode;

const USAGE: &str = "\
usage: cargo xtask <task> [name ...]

tasks:
  prove     run the Kani harnesses of verification/proofs.toml and write a table
  mutants   show that the test twin of each proof catches its deliberate fault
            (with --kani also that Kani does)

Names narrow a task to the proofs with those ids or harness names.";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match arguments.split_first() {
        Some((task, names)) if task == "prove" => prove::run(names),
        Some((task, names)) if task == "mutants" => mutants::run(names),
        _ => Err(USAGE.to_owned()),
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}
