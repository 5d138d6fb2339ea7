//! Runs the harnesses under Kani and records its verdict on each.

use crate::error::Error;
use crate::kani_output::{self, Export, Proven, Refused};
use crate::process;
use jcas_ledger::{
    Ledger, Outcome, Proof, ProofVerdict, Results, Run, Solver, Sources, read, workspace_root,
};
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// Seconds by the clock after which a harness counts as not solved. That is ten minutes on a
/// machine of its own, and longer on a busy one.
const LIMIT_S: u64 = 1800;
/// Seconds that building a crate for Kani may take.
const BUILD_S: u64 = 900;
/// Most harnesses of one call. Kani writes its export when the last one is done.
const CALL_MAX: usize = 16;

/// The result of one harness.
pub struct Judged {
    pub proof: Proof,
    pub verdict: Result<Proven, Refused>,
    /// The name of the solver that ran, from its own output.
    solver: Option<String>,
    /// The workspace's files that the checked program has a line of.
    files: Vec<String>,
}

/// Proves the harnesses that `arguments` select and records the verdicts; true if all were proven.
/// `--changed` leaves out those that are verified on these sources.
pub fn run(arguments: &[String]) -> Result<bool, Error> {
    let (options, names): (Vec<_>, Vec<_>) = arguments
        .iter()
        .cloned()
        .partition(|argument| argument.starts_with("--"));
    if let Some(unknown) = options.iter().find(|option| *option != "--changed") {
        return Err(Error::ProveOption(unknown.clone()));
    }
    let ledger = Ledger::read()?;
    let mut proofs = ledger.select(&names)?;
    let root = workspace_root();
    let sources = Sources::read(&root, &ledger)?;
    if !options.is_empty() {
        let results = Results::read()?;
        proofs.retain(|proof| !results.is_current(proof, &sources));
    }
    require_kani()?;
    let commit = clean_commit(&root, &ledger)?;
    if commit.is_none() {
        eprintln!("The sources have changes that are not committed: nothing will be recorded.");
    }
    let (begin, mut proven) = (Instant::now(), 0);
    for group in groups(&proofs) {
        eprintln!(
            "{}, {}: {} harnesses",
            group[0].package,
            group[0].solver,
            group.len()
        );
        let (judged, versions) = prove(&group, &root, &sources)?;
        for one in &judged {
            println!("{}", line(one));
            proven += usize::from(one.verdict.is_ok());
        }
        // The verdicts are recorded after each call, so that an interrupted run keeps them.
        if let Some(commit) = &commit {
            let (kani, cbmc) = versions.unwrap_or_default();
            let run = Run {
                commit: commit.clone(),
                date: output("date", &["-u", "+%F"])?,
                kani,
                cbmc,
                machine: machine(),
            };
            record(&ledger, run, judged, &sources)?;
        }
    }
    let wall_s = begin.elapsed().as_secs_f64();
    println!(
        "{proven} of {} proven in {wall_s:.0} s by the clock",
        proofs.len()
    );
    Ok(proven == proofs.len())
}

/// Proofs that one call of Kani can check with one compilation: same package, solver and flags.
fn groups(proofs: &[Proof]) -> Vec<Vec<&Proof>> {
    let mut groups: Vec<Vec<&Proof>> = Vec::new();
    for proof in proofs {
        let same = |group: &&mut Vec<&Proof>| {
            let first = group[0];
            group.len() < CALL_MAX
                && first.package == proof.package
                && first.solver == proof.solver
                && first.flags == proof.flags
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.push(proof),
            None => groups.push(vec![proof]),
        }
    }
    groups
}

/// The arguments with which cargo checks a group.
fn arguments(group: &[&Proof], export: &Path) -> Vec<String> {
    let first = group[0];
    let mut arguments = vec!["kani".to_owned(), "-p".to_owned(), first.package.clone()];
    for proof in group {
        arguments.extend(["--harness".to_owned(), proof.harness.clone()]);
    }
    let (limit, solver) = (format!("{LIMIT_S}s"), first.solver.to_string());
    let export = export.to_string_lossy();
    let common = [
        "--exact",
        "-Z",
        "function-contracts",
        "-Z",
        "loop-contracts",
        "-Z",
        "stubbing",
        "-Z",
        "unstable-options",
        "--harness-timeout",
        &limit,
        "--solver",
        &solver,
        "--export-json",
        &export,
    ];
    arguments.extend(common.map(str::to_owned));
    arguments.extend(first.flags.iter().cloned());
    arguments
}

/// The versions of Kani and CBMC.
type Versions = (String, String);

/// Runs one group of the workspace at `root`; also returns the versions of Kani and CBMC.
pub fn prove(
    group: &[&Proof],
    root: &Path,
    sources: &Sources,
) -> Result<(Vec<Judged>, Option<Versions>), Error> {
    // A name of this process alone: runs side by side must not read each other's export.
    let name = format!("jcas-kani-{}.json", std::process::id());
    let path = std::env::temp_dir().join(name);
    // What an earlier call left must not pass for this one's.
    let _ = std::fs::remove_file(&path);
    let mut command = Command::new("cargo");
    command
        .current_dir(root)
        // Kani brings its own compiler, so the toolchain of this task is not passed on.
        .env_remove("RUSTUP_TOOLCHAIN")
        .env_remove("RUSTC")
        .args(arguments(group, &path));
    let limit = Duration::from_secs(LIMIT_S * group.len() as u64 + BUILD_S);
    let finished = process::run(&mut command, limit)?;
    let export = read(&path)
        .map_err(Error::from)
        .and_then(|text| Export::parse(&text));
    let _ = std::fs::remove_file(&path);
    let versions = export.as_ref().ok();
    let versions = versions.map(|export| (export.kani().to_owned(), export.cbmc().to_owned()));
    let files = |harness: &str| {
        let program = export
            .as_ref()
            .ok()
            .and_then(|export| export.program(harness));
        program.map_or_else(Vec::new, |program| files_of(&program, sources))
    };
    Ok((judge(group, &finished, &export, files), versions))
}

/// The result of each proof of one call.
fn judge(
    group: &[&Proof],
    finished: &process::Finished,
    export: &Result<Export, Error>,
    files: impl Fn(&str) -> Vec<String>,
) -> Vec<Judged> {
    let mut judged = Vec::new();
    for proof in group {
        let verdict = match export {
            Ok(export) => export.accept(&proof.harness, proof.covers),
            Err(_) if finished.timed_out => {
                let why = format!("stopped after {} s", finished.elapsed.as_secs());
                Err(Refused::new(ProofVerdict::Unfinished, why))
            }
            Err(broken) => {
                let why = explain(&finished.output, &broken.to_string());
                Err(Refused::new(ProofVerdict::Unfinished, why))
            }
        };
        judged.push(Judged {
            proof: (*proof).clone(),
            verdict,
            solver: kani_output::solver(&finished.output, &proof.harness),
            files: files(&proof.harness),
        });
    }
    judged
}

/// The reason why there is no export: the compiler's or Kani's first error.
fn explain(output: &str, broken: &str) -> String {
    let is_error = |line: &&str| line.starts_with("error") || line.starts_with("Error");
    output.lines().find(is_error).unwrap_or(broken).to_owned()
}

/// The workspace's files that a linked program has a line of, by CBMC's own list.
fn files_of(program: &str, sources: &Sources) -> Vec<String> {
    let listed = Command::new("goto-instrument")
        .args(["--list-eloc", program])
        .output();
    let listed = listed.map(|listed| String::from_utf8_lossy(&listed.stdout).into_owned());
    let mut files: Vec<String> = listed
        .unwrap_or_default()
        .lines()
        .filter_map(|line| Some(line.rsplit_once(':')?.0.to_owned()))
        .filter(|file| sources.has(file))
        .collect();
    files.sort();
    files.dedup();
    files
}

fn line(judged: &Judged) -> String {
    let name = &judged.proof.harness;
    let solver = judged.solver.as_deref().unwrap_or("no solver");
    match &judged.verdict {
        Ok(p) => format!(
            "{} {name}: proven, {} checks ({} unreachable), {} covers, {:.1} s, {solver}",
            judged.proof.id, p.checks, p.unreachable, p.covers, p.seconds
        ),
        Err(refused) => {
            format!(
                "{} {name}: NOT PROVEN, {}, {solver}",
                judged.proof.id, refused.why
            )
        }
    }
}

/// Writes the verdicts into `results.toml` and regenerates the page.
fn record(ledger: &Ledger, run: Run, judged: Vec<Judged>, sources: &Sources) -> Result<(), Error> {
    let mut results = Results::read()?;
    let outcomes = judged
        .into_iter()
        .map(|one| outcome(one, &run.commit, sources))
        .collect();
    results.record(run, outcomes);
    publish(ledger, results, sources)
}

/// Writes the results and their page.
pub fn publish(ledger: &Ledger, mut results: Results, sources: &Sources) -> Result<(), Error> {
    results.prune(ledger);
    results.write()?;
    let page = jcas_ledger::page(ledger, &results, sources);
    Ok(jcas_ledger::write(
        &workspace_root().join("verification/RESULTS.md"),
        &page,
    )?)
}

fn outcome(judged: Judged, commit: &str, sources: &Sources) -> Outcome {
    let asked = judged.proof.solver;
    let mut outcome = Outcome {
        package: judged.proof.package,
        harness: judged.proof.harness,
        commit: commit.to_owned(),
        verdict: ProofVerdict::Verified,
        checks: None,
        covers: None,
        seconds: None,
        solver: judged.solver,
        mutant: None,
        note: None,
        sources: sources.fingerprint(&judged.files).unwrap_or_default(),
        files: judged.files,
    };
    match judged.verdict {
        // Without its files a verdict would stay true after any change.
        Ok(_) if outcome.files.is_empty() => {
            outcome.verdict = ProofVerdict::Unfinished;
            outcome.note = Some("goto-instrument did not list the program".to_owned());
        }
        Ok(proven) => {
            outcome.checks = u32::try_from(proven.checks).ok();
            outcome.covers = u32::try_from(proven.covers).ok();
            outcome.seconds = Some(proven.seconds);
            outcome.note = other_solver(asked, outcome.solver.as_deref());
        }
        Err(refused) => {
            outcome.verdict = refused.verdict;
            outcome.note = Some(refused.why);
        }
    }
    outcome
}

/// A message where another solver ran than the requested one. A CBMC built without the requested
/// solver uses another one without an error.
fn other_solver(asked: Solver, ran: Option<&str>) -> Option<String> {
    let ran = ran?.to_lowercase();
    // Kissat runs outside CBMC, which then prints "external SAT solver".
    let same = ran.starts_with(&asked.to_string()) || asked == Solver::Kissat;
    (!same).then(|| format!("{asked} was asked for"))
}

/// An error with the installation command where Kani is missing or older than its export.
pub fn require_kani() -> Result<(), Error> {
    let help = Command::new("cargo").args(["kani", "--help"]).output();
    let help = help.map_err(Error::start("cargo"))?;
    if String::from_utf8_lossy(&help.stdout).contains("--export-json") {
        return Ok(());
    }
    Err(Error::Usage(
        "There is no Kani with --export-json, which 0.68 has: `cargo install --locked \
         kani-verifier && cargo kani setup`.\nWithout it, `cargo test` runs every harness on \
         random inputs, which is a test and not a proof.",
    ))
}

/// The abbreviated commit, or `None` where the ledger or a source has uncommitted changes.
fn clean_commit(root: &Path, ledger: &Ledger) -> Result<Option<String>, Error> {
    let root = root.to_string_lossy();
    let mut arguments = vec!["-C", &root, "status", "--porcelain", "--"];
    arguments.push("verification/proofs.toml");
    arguments.extend(ledger.sources.iter().map(String::as_str));
    if output("git", &arguments)?.is_empty() {
        output("git", &["-C", &root, "rev-parse", "--short=7", "HEAD"]).map(Some)
    } else {
        Ok(None)
    }
}

/// The number of processors, and their load in the last minutes.
fn machine() -> String {
    let processors = std::thread::available_parallelism().map_or(1, |count| count.get());
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split(' ').nth(2).unwrap_or("unknown").to_owned();
    format!("{processors} processors, load {load}")
}

/// The first line of a command's output.
fn output(program: &str, arguments: &[&str]) -> Result<String, Error> {
    let run = Command::new(program).args(arguments).output();
    let run = run.map_err(Error::start(program))?;
    if !run.status.success() {
        let printed = String::from_utf8_lossy(&run.stderr).into_owned();
        return Err(Error::Printed(printed));
    }
    let text = String::from_utf8_lossy(&run.stdout);
    Ok(text.lines().next().unwrap_or_default().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kani_output::tests::{HARNESS, PROVEN, ended};

    fn proof(harness: &str) -> Proof {
        let ledger = Ledger::read().unwrap();
        let mut proof = ledger.proof[0].clone();
        proof.harness = harness.to_owned();
        proof.covers = 1;
        proof
    }

    fn finished(output: &str, timed_out: bool) -> process::Finished {
        process::Finished {
            output: output.to_owned(),
            success: false,
            timed_out,
            elapsed: Duration::from_secs(9),
        }
    }

    fn outcome_of(export: &str, printed: &process::Finished, files: &[&str]) -> Outcome {
        let ledger = Ledger::read().unwrap();
        let sources = Sources::read(&workspace_root(), &ledger).unwrap();
        let files: Vec<String> = files.iter().map(|file| (*file).to_owned()).collect();
        let proof = proof(HARNESS);
        let export = Export::parse(export);
        let mut judged = judge(&[&proof], printed, &export, |_| files.clone());
        outcome(judged.remove(0), "0123456", &sources)
    }

    /// Catches a verdict that is recorded as better than Kani's export is.
    #[test]
    fn outcomes_are_what_kani_exported() {
        let printed = format!("Checking harness {HARNESS}...\nSolving with MiniSAT 2.2.1\n");
        let printed = finished(&printed, false);
        let files = ["core/src/rules/energy.rs"];
        let proven = outcome_of(PROVEN, &printed, &files);
        assert_eq!(proven.verdict, ProofVerdict::Verified);
        assert_eq!((proven.checks, proven.covers), (Some(3), Some(1)));
        assert_eq!(proven.seconds, Some(0.815));
        assert_eq!(proven.solver.as_deref(), Some("MiniSAT 2.2.1"));
        assert_eq!(proven.note.as_deref(), Some("cadical was asked for"));
        assert_eq!(proven.sources.len(), 16);
        let late = outcome_of(&ended("timeout"), &printed, &files);
        assert_eq!(late.verdict, ProofVerdict::NotSolved);
        let unlisted = outcome_of(PROVEN, &printed, &[]);
        assert_eq!(unlisted.verdict, ProofVerdict::Unfinished);
    }

    /// Catches an export that is missing or was cut, as where the disk is full, and that passes.
    #[test]
    fn without_an_export_nothing_is_shown() {
        let broken = outcome_of("", &finished("error[E0425]: no such name\n", false), &[]);
        assert_eq!(broken.verdict, ProofVerdict::Unfinished);
        assert!(broken.note.unwrap().contains("E0425"));
        let full = finished("Error: No space left on device (os error 28)\n", false);
        let cut = outcome_of(&PROVEN[..99], &full, &[]);
        assert_eq!(cut.verdict, ProofVerdict::Unfinished);
        assert!(cut.note.unwrap().contains("No space"));
        let stopped = outcome_of("", &finished("", true), &[]);
        assert_eq!(stopped.note.as_deref(), Some("stopped after 9 s"));
        assert!(stopped.sources.len() == 16 && stopped.files.is_empty());
    }

    #[test]
    fn proofs_of_one_call_share_all_that_the_call_fixes() {
        let proofs = Ledger::read().unwrap().proof;
        let groups = groups(&proofs);
        assert_eq!(groups.iter().map(Vec::len).sum::<usize>(), proofs.len());
        for group in &groups {
            let first = group[0];
            assert!(group.iter().all(|proof| proof.flags == first.flags));
            let line = arguments(group, Path::new("kani.json")).join(" ");
            assert!(
                line.contains(&format!("--solver {}", first.solver)),
                "{line}"
            );
            assert_eq!(line.matches("--harness proofs::").count(), group.len());
        }
        assert!(groups.len() < proofs.len() / 4, "{} calls", groups.len());
    }

    /// Catches flags that Kani would pass to CBMC: it passes on all that follows `--cbmc-args`.
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
