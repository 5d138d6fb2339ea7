//! Shows that each proof notices its deliberate fault.
//!
//! A mutant is a line of the code behind `#[cfg(jcas_mutant = "name")]`. The test
//! twin of the proof must pass without it and fail with it.

use crate::ledger::{Ledger, Proof, workspace_root};
use crate::{process, prove, report};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

const LIMIT: Duration = Duration::from_secs(900);

/// Tries the mutants that `names` select; true if every one is caught.
pub fn run(arguments: &[String]) -> Result<bool, String> {
    let with_kani = arguments.iter().any(|argument| argument == "--kani");
    let names: Vec<String> = arguments
        .iter()
        .filter(|name| *name != "--kani")
        .cloned()
        .collect();
    let proofs = Ledger::read()?.select(&names)?;
    if with_kani {
        prove::require_kani()?;
    }
    let mut rows = vec![
        ["id", "proof", "mutant", "twin", "Kani"]
            .map(str::to_owned)
            .to_vec(),
    ];
    let mut all_caught = true;
    for proof in &proofs {
        eprint!("{} {} / {} ... ", proof.id, proof.name(), proof.mutant);
        let twin = twin_verdict(proof)?;
        let kani = if with_kani {
            kani_verdict(proof)?
        } else {
            "not asked".to_owned()
        };
        eprintln!("{twin}");
        all_caught &= twin == "caught" && (!with_kani || kani == "caught");
        rows.push(vec![
            proof.id.clone(),
            proof.name().to_owned(),
            proof.mutant.clone(),
            twin,
            kani,
        ]);
    }
    let path = workspace_root().join("target/proofs/mutants.md");
    report::write(&path, &report::table(&rows))?;
    println!("{}", report::table(&rows));
    println!("written to {}", path.display());
    Ok(all_caught)
}

/// The twin passes on the code as it is and fails on the mutant.
fn twin_verdict(proof: &Proof) -> Result<String, String> {
    Ok(
        match (
            run_twin(proof, None)?,
            run_twin(proof, Some(&proof.mutant))?,
        ) {
            (Twin::Passed, Twin::Failed) => "caught".to_owned(),
            (Twin::Passed, Twin::Passed) => "MISSED".to_owned(),
            (Twin::Passed, Twin::Broken) => "MUTANT DOES NOT RUN".to_owned(),
            (Twin::Failed, _) => "FAILS WITHOUT THE MUTANT".to_owned(),
            (Twin::Broken, _) => "TWIN DOES NOT RUN".to_owned(),
        },
    )
}

fn kani_verdict(proof: &Proof) -> Result<String, String> {
    let cfg = format!("jcas_mutant=\"{}\"", proof.mutant);
    Ok(match prove::prove(proof, &[cfg])? {
        Err(why) if why.starts_with("FAILURE") => "caught".to_owned(),
        Err(why) => format!("UNCLEAR: {}", why.replace('|', "/")),
        Ok(_) => "MISSED".to_owned(),
    })
}

enum Twin {
    Passed,
    Failed,
    /// Did not compile, or there is no such test.
    Broken,
}

fn run_twin(proof: &Proof, mutant: Option<&str>) -> Result<Twin, String> {
    let mut command = Command::new("cargo");
    command.current_dir(workspace_root()).args([
        "test",
        "--quiet",
        "-p",
        &proof.package,
        "--lib",
        "--",
        "--exact",
        &proof.twin(),
    ]);
    if let Some(mutant) = mutant {
        command.env("RUSTC_WORKSPACE_WRAPPER", wrapper(mutant)?);
    }
    let finished = process::run(&mut command, LIMIT)?;
    let ran_one = |result: &str| finished.output.contains(result);
    Ok(if finished.success && ran_one("1 passed; 0 failed") {
        Twin::Passed
    } else if ran_one("0 passed; 1 failed") {
        Twin::Failed
    } else {
        Twin::Broken
    })
}

/// A wrapper around rustc that switches a mutant on in the workspace's own crates.
///
/// Cargo keeps the builds of different wrappers apart and shares the dependencies,
/// so only the crates that can hold a mutant are built again.
fn wrapper(mutant: &str) -> Result<PathBuf, String> {
    let path = workspace_root().join(format!("target/proofs/with-{mutant}.sh"));
    let script = format!("#!/bin/sh\nexec \"$@\" --cfg 'jcas_mutant=\"{mutant}\"'\n");
    if std::fs::read_to_string(&path).is_ok_and(|text| text == script) {
        return Ok(path);
    }
    report::write(&path, &script)?;
    make_executable(&path)?;
    Ok(path)
}

fn make_executable(path: &Path) -> Result<(), String> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755))
        .map_err(|error| format!("{}: {error}", path.display()))
}
