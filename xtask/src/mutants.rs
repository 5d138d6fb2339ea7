//! Shows that each proof notices its deliberate fault.
//!
//! A mutant is one edit of the kernel's text, named in the ledger. The edit is made
//! in a copy of the sources, never in the sources. The proof's test twin must pass
//! in the copy without the edit and fail with it; and with `--kani`, so must the proof.
//! RESULTS.md tells what Kani said.

use crate::error::Error;
use crate::kani_output::{Proven, Refused};
use crate::{process, prove, report};
use jcas_ledger::{
    Ledger, Mutant, Proof, ProofVerdict, Results, Sources, read, workspace_root, write,
};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

const LIMIT: Duration = Duration::from_secs(900);

/// Crates that hold mutants and their twins, and those that they depend on.
const CRATES: [&str; 7] = [
    "core",
    "ffi",
    "plan",
    "policy",
    "simd",
    "trace",
    "verification",
];

/// Tries the mutants that `names` select; true if every one is caught.
pub fn run(arguments: &[String]) -> Result<bool, Error> {
    let with_kani = arguments.iter().any(|argument| argument == "--kani");
    let names: Vec<String> = arguments
        .iter()
        .filter(|name| *name != "--kani")
        .cloned()
        .collect();
    let ledger = Ledger::read()?;
    let (proofs, sources) = (
        ledger.select(&names)?,
        Sources::read(&workspace_root(), &ledger)?,
    );
    if with_kani {
        prove::require_kani()?;
    }
    let copy = Copy::make()?;
    let mut rows = vec![
        ["id", "proof", "mutant of", "twin", "Kani"]
            .map(str::to_owned)
            .to_vec(),
    ];
    // All twins without a mutant first: one build serves them all.
    let mut before = Vec::new();
    for proof in &proofs {
        before.push(copy.run_twin(proof)?);
    }
    let mut all_caught = true;
    for (proof, before) in proofs.iter().zip(before) {
        eprint!("{} {} ... ", proof.id, proof.name());
        let (twin, kani) = copy.verdicts(proof, before, with_kani.then_some(&sources))?;
        eprintln!("{twin}, under Kani {kani}");
        if with_kani {
            let mut results = Results::read()?;
            results.tell_mutant(proof, &sources, &kani);
            prove::publish(&ledger, results, &sources)?;
        }
        all_caught &= twin == "caught" && (!with_kani || kani == "caught");
        rows.push(vec![
            proof.id.clone(),
            proof.name().to_owned(),
            proof.mutant.file.clone(),
            twin,
            kani,
        ]);
    }
    let path = workspace_root().join("target/proofs/mutants.md");
    write(&path, &report::table(&rows))?;
    println!("{}", report::table(&rows));
    println!("written to {}", path.display());
    Ok(all_caught)
}

/// A copy of the crates that hold mutants, as a workspace of its own.
struct Copy {
    root: PathBuf,
}

enum Twin {
    Passed,
    Failed,
    /// The mutant did not compile, or there is no such test.
    Broken,
}

impl Copy {
    fn make() -> Result<Self, Error> {
        let root = workspace_root().join("target/proofs/mutants");
        for name in CRATES {
            copy_folder(&workspace_root().join(name), &root.join(name))?;
        }
        for name in ["Cargo.lock", "rust-toolchain.toml"] {
            write(&root.join(name), &read(&workspace_root().join(name))?)?;
        }
        let manifest = read(&workspace_root().join("Cargo.toml"))?;
        write(&root.join("Cargo.toml"), &with_members(&manifest)?)?;
        Ok(Copy { root })
    }

    /// The result of the twin, and where `sources` are given of Kani, for the mutant; `before` is
    /// the twin's result without it.
    fn verdicts(
        &self,
        proof: &Proof,
        before: Twin,
        sources: Option<&Sources>,
    ) -> Result<(String, String), Error> {
        // A harness that is verified on these sources need not be proven once more.
        let proven = match sources {
            Some(now) if Results::read()?.is_current(proof, now) => None,
            Some(now) => self.prove(proof, now)?.err(),
            None => None,
        };
        let original = read(&self.root.join(&proof.mutant.file))?;
        let mutated = apply(&proof.mutant, &original)?;
        write(&self.root.join(&proof.mutant.file), &mutated)?;
        let after = self.run_twin(proof);
        let kani = match (sources, proven) {
            (None, _) => Ok("not asked".to_owned()),
            (_, Some(refused)) => Ok(not_proven(&refused)),
            (Some(now), None) => self.prove(proof, now).map(kani_verdict),
        };
        write(&self.root.join(&proof.mutant.file), &original)?;
        Ok((twin_verdict(before, after?).to_owned(), kani?))
    }

    /// Kani's result for the harness in the copy as it is.
    fn prove(&self, proof: &Proof, now: &Sources) -> Result<Result<Proven, Refused>, Error> {
        let (mut judged, _) = prove::prove(&[proof], &self.root, now)?;
        Ok(judged.remove(0).verdict)
    }

    fn run_twin(&self, proof: &Proof) -> Result<Twin, Error> {
        let mut command = Command::new("cargo");
        command
            .current_dir(&self.root)
            .env(
                "CARGO_TARGET_DIR",
                workspace_root().join("target/proofs/build"),
            )
            .args([
                "test",
                "--quiet",
                "-p",
                &proof.package,
                "--lib",
                "--",
                "--exact",
            ])
            .arg(proof.twin());
        let finished = process::run(&mut command, LIMIT)?;
        let ran = |result: &str| finished.output.contains(result);
        Ok(if finished.success && ran("1 passed; 0 failed") {
            Twin::Passed
        } else if ran("0 passed; 1 failed") {
            Twin::Failed
        } else {
            Twin::Broken
        })
    }
}

/// Kani's result for a harness that it proved without the mutant.
fn kani_verdict(with_the_mutant: Result<Proven, Refused>) -> String {
    match with_the_mutant {
        Err(refused) if refused.verdict == ProofVerdict::Failed => "caught".to_owned(),
        Err(refused) => format!("UNCLEAR: {}", refused.why.replace('|', "/")),
        Ok(_) => "MISSED".to_owned(),
    }
}

/// A harness that is not proven without the mutant catches nothing.
fn not_proven(refused: &Refused) -> String {
    format!(
        "NOT PROVEN WITHOUT THE MUTANT: {}",
        refused.why.replace('|', "/")
    )
}

fn twin_verdict(before: Twin, after: Twin) -> &'static str {
    match (before, after) {
        (Twin::Passed, Twin::Failed) => "caught",
        (Twin::Passed, Twin::Passed) => "MISSED",
        (Twin::Passed, Twin::Broken) => "MUTANT DOES NOT COMPILE",
        (Twin::Failed, _) => "FAILS WITHOUT THE MUTANT",
        (Twin::Broken, _) => "TWIN DOES NOT RUN",
    }
}

/// The text after the one edit of a mutant.
fn apply(mutant: &Mutant, text: &str) -> Result<String, Error> {
    match text.matches(&mutant.find).count() {
        1 => Ok(text.replace(&mutant.find, &mutant.replace)),
        places => Err(Error::Places {
            file: mutant.file.clone(),
            places,
            find: mutant.find.clone(),
        }),
    }
}

/// The workspace's manifest with only the copied crates as members.
fn with_members(manifest: &str) -> Result<String, Error> {
    manifest
        .split_once("\nmembers = [")
        .and_then(|(before, list)| Some((before, list.split_once(']')?.1)))
        .map(|(before, after)| format!("{before}\nmembers = {CRATES:?}{after}"))
        .ok_or(Error::NoMembers)
}

/// Copies only the files that have changed, so that Cargo rebuilds only what depends on them.
fn copy_folder(from: &Path, to: &Path) -> Result<(), Error> {
    let explain = Error::file(from);
    for entry in std::fs::read_dir(from).map_err(&explain)? {
        let entry = entry.map_err(&explain)?;
        let (source, target) = (entry.path(), to.join(entry.file_name()));
        if entry.file_type().map_err(&explain)?.is_dir() {
            copy_folder(&source, &target)?;
        } else {
            let bytes = std::fs::read(&source).map_err(&explain)?;
            if std::fs::read(&target).ok().as_ref() != Some(&bytes) {
                std::fs::create_dir_all(to).map_err(&explain)?;
                std::fs::write(&target, bytes).map_err(&explain)?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mutant(find: &str) -> Mutant {
        Mutant {
            file: "x.rs".into(),
            find: find.into(),
            replace: "a - b".into(),
        }
    }

    #[test]
    fn a_mutant_edits_exactly_one_place() {
        assert_eq!(
            apply(&mutant("a + b"), "let c = a + b;").unwrap(),
            "let c = a - b;"
        );
        assert!(
            apply(&mutant("a + b"), "let c = a;")
                .unwrap_err()
                .to_string()
                .contains("0 places")
        );
        assert!(
            apply(&mutant("a"), "a + a")
                .unwrap_err()
                .to_string()
                .contains("2 places")
        );
    }

    #[test]
    fn the_copied_workspace_has_the_copied_members() {
        for members in ["[\"x\", \"y\"]", "[\n    \"x\",\n    \"y\",\n]"] {
            let manifest = format!("[workspace]\nmembers = {members}\n[profile]\n");
            let copied = with_members(&manifest).unwrap();
            assert_eq!(
                copied,
                "[workspace]\nmembers = [\"core\", \"ffi\", \"plan\", \"policy\", \"simd\", \
                 \"trace\", \"verification\"]\n[profile]\n"
            );
        }
        assert!(with_members("[workspace]\n").is_err());
    }

    #[test]
    fn only_a_twin_that_turns_from_passing_to_failing_has_caught_it() {
        assert_eq!(twin_verdict(Twin::Passed, Twin::Failed), "caught");
        assert_eq!(twin_verdict(Twin::Passed, Twin::Passed), "MISSED");
        assert_ne!(twin_verdict(Twin::Failed, Twin::Failed), "caught");
        assert_ne!(twin_verdict(Twin::Passed, Twin::Broken), "caught");
    }

    #[test]
    fn kani_catches_only_what_it_proves_without_the_mutant() {
        let failed = Refused::new(ProofVerdict::Failed, "Failure: assertion failed: x");
        assert_ne!(not_proven(&failed), "caught");
        assert_eq!(kani_verdict(Err(failed)), "caught");
        let late = Refused::new(ProofVerdict::NotSolved, "CBMC timed out");
        assert!(kani_verdict(Err(late)).starts_with("UNCLEAR"));
        let proven = Proven {
            checks: 1,
            unreachable: 0,
            covers: 1,
            seconds: 1.0,
        };
        assert_eq!(kani_verdict(Ok(proven)), "MISSED");
    }
}
