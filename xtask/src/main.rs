//! Development tasks of jcas: `cargo xtask <task>`.

mod dist;
mod error;
mod fmu;
mod kani_output;
mod mutants;
mod paths;
mod process;
mod prove;
mod report;
mod tidy;
mod web;

use std::process::ExitCode;

const USAGE: &str = "\
usage: cargo xtask <task> [name ...]

tasks:
  prove     run the Kani harnesses of verification/proofs.toml and record the
            verdicts in verification/results.toml and RESULTS.md (--changed
            leaves out those that are verified on these sources)
  mutants   show that the test twin of each proof catches its deliberate fault
            (with --kani also that Kani does)
  tidy      find long and vague sentences, and files that nothing names
  fmu       pack the kernel as a Functional Mock-up Unit, FMI 3.0 (--out FILE)
  web       write the playground as one page, with the kernel inside
            (--out FILE; --wasm FILE for a kernel that is built already)
  dist      write what is served to users without Rust, with checksums, into dist/
            (--out FOLDER; --target TRIPLE, more than once, narrows the platforms)

Names narrow a task to the proofs with those ids or harness names.";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match arguments.split_first() {
        Some((task, names)) if task == "prove" => prove::run(names),
        Some((task, names)) if task == "mutants" => mutants::run(names),
        Some((task, options)) if task == "tidy" => tidy::run(options),
        Some((task, options)) if task == "fmu" => fmu::run(options),
        Some((task, options)) if task == "dist" => dist::run(options),
        Some((task, options)) if task == "web" => web::run(options),
        _ => Err(error::Error::Usage(USAGE)),
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}
