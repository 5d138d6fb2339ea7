//! Runs the harnesses under Kani, one by one, and writes the table of results.

use crate::kani_output::{Proven, Report};
use crate::ledger::{Ledger, Proof, workspace_root};
use crate::{process, report};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Time that building a crate for Kani may add to a harness's own limit.
const BUILD_S: u64 = 600;

/// Columns of the table of results.
const HEADING: [&str; 9] = [
    "id",
    "harness",
    "claim",
    "bound",
    "assumptions",
    "result",
    "checks",
    "covers",
    "seconds",
];

/// Proves what `names` select; true if everything was proven.
pub fn run(names: &[String]) -> Result<bool, String> {
    let proofs = Ledger::read()?.select(names)?;
    require_kani()?;
    let mut rows = vec![HEADING.map(str::to_owned).to_vec()];
    let mut all_proven = true;
    for proof in &proofs {
        eprint!("{} {} ... ", proof.id, proof.name());
        let verdict = prove(proof, &workspace_root())?;
        eprintln!(
            "{}",
            verdict
                .as_ref()
                .map_or_else(|why| why.clone(), |_| "proven".to_owned())
        );
        all_proven &= verdict.is_ok();
        rows.push(row(proof, &verdict));
    }
    let path = results_path();
    report::write(&path, &report::table(&rows))?;
    println!("{}", report::table(&rows));
    println!("written to {}", path.display());
    Ok(all_proven)
}

/// Runs one harness of the workspace at `root`.
pub fn prove(proof: &Proof, root: &Path) -> Result<Result<Proven, String>, String> {
    let mut command = Command::new("cargo");
    command
        .current_dir(root)
        // Kani brings a compiler of its own; the one that runs this task is not to be passed on.
        .env_remove("RUSTUP_TOOLCHAIN")
        .env_remove("RUSTC")
        .args([
            "kani",
            "-p",
            &proof.package,
            "--harness",
            &proof.harness,
            "--exact",
        ])
        .args([
            "-Z",
            "function-contracts",
            "-Z",
            "stubbing",
            "-Z",
            "unstable-options",
        ])
        .args(["--harness-timeout", &format!("{}s", proof.time_limit_s())])
        .args(["--output-format", "regular"])
        .args(&proof.flags);
    let limit = Duration::from_secs(proof.time_limit_s() + BUILD_S);
    let finished = process::run(&mut command, limit)?;
    if finished.timed_out {
        return Ok(Err(format!(
            "stopped after {} s",
            finished.elapsed.as_secs()
        )));
    }
    let verdict = Report::parse(&finished.output).accept(&proof.harness, proof.covers);
    if verdict.is_ok() && !finished.success {
        return Ok(Err("cargo kani ended with an error".to_owned()));
    }
    Ok(verdict.map_err(|why| explain(why, &finished.output)))
}

/// Adds the compiler's first error to a verdict that is only its consequence.
fn explain(why: String, output: &str) -> String {
    let error = output.lines().find(|line| line.starts_with("error"));
    match error {
        Some(error) if why.starts_with("expected the harness") => format!("{why}; {error}"),
        _ => why,
    }
}

fn row(proof: &Proof, verdict: &Result<Proven, String>) -> Vec<String> {
    let mut cells = vec![
        proof.id.clone(),
        proof.name().to_owned(),
        proof.claim.clone(),
        proof.bound.clone(),
        proof.assumptions.join(", "),
    ];
    match verdict {
        Ok(proven) => cells.extend([
            "proven".to_owned(),
            format!("{} ({} unreachable)", proven.checks, proven.unreachable),
            format!("{} of {}", proven.covers, proof.covers),
            format!("{:.1}", proven.seconds),
        ]),
        Err(why) => cells.extend([
            format!("NOT PROVEN: {}", why.replace('|', "/")),
            "-".to_owned(),
            "-".to_owned(),
            "-".to_owned(),
        ]),
    }
    cells
}

/// Stops early, with the way to install it, where Kani is missing.
pub fn require_kani() -> Result<(), String> {
    let version = Command::new("cargo").args(["kani", "--version"]).output();
    match version {
        Ok(output) if output.status.success() => Ok(()),
        _ => Err(
            "Kani is not installed: `cargo install --locked kani-verifier --version 0.67.0 \
                  && cargo kani setup`.\nWithout it, `cargo test` runs every harness on random \
                  inputs, which is a test and not a proof."
                .to_owned(),
        ),
    }
}

fn results_path() -> PathBuf {
    workspace_root().join("target/proofs/results.md")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Catches a column without a heading, and a verdict that breaks the table.
    #[test]
    fn every_cell_has_a_heading() {
        let proofs = Ledger::read().unwrap().select(&[]).unwrap();
        let proven = Proven {
            checks: 3,
            unreachable: 1,
            covers: 1,
            seconds: 0.8,
        };
        for verdict in [Ok(proven), Err("CBMC timed out".to_owned())] {
            let cells = row(&proofs[0], &verdict);
            assert_eq!(cells.len(), HEADING.len());
        }
        let late = row(&proofs[0], &Err("CBMC timed out".to_owned()));
        assert_eq!(late[5], "NOT PROVEN: CBMC timed out");
    }

    /// Catches flags that Kani would take for CBMC's: what follows `--cbmc-args` is passed on to CBMC.
    #[test]
    fn flags_of_cbmc_come_last() {
        for proof in Ledger::read().unwrap().proof {
            let mut after = proof.flags.iter().skip_while(|flag| *flag != "--cbmc-args");
            assert!(
                after.all(|flag| flag != "--no-assertion-reach-checks"),
                "{}",
                proof.harness
            );
        }
    }
}
