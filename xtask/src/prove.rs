//! Runs the harnesses under Kani and records its verdict on each.

use crate::kani_output::{self, HarnessReport, Proven};
use crate::process;
use jcas_ledger::{Ledger, Outcome, Proof, ProofVerdict, Results, Run, Solver, workspace_root};
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// Seconds that building a crate for Kani may add to the time limits of its harnesses.
const BUILD_S: u64 = 600;

/// The result of one harness.
pub struct Judged {
    pub proof: Proof,
    pub verdict: Result<Proven, String>,
    /// The name of the solver that ran, from its own output.
    pub solver: Option<String>,
}

/// Proves the harnesses that `names` select and records the verdicts; true if all were proven.
pub fn run(names: &[String]) -> Result<bool, String> {
    let ledger = Ledger::read()?;
    let proofs = ledger.select(names)?;
    let kani = require_kani()?;
    let root = workspace_root();
    let commit = clean_commit(&root, &ledger)?;
    if commit.is_none() {
        eprintln!("The sources have changes that are not committed: nothing will be recorded.");
    }
    let (begin, mut proven, mut solver_s) = (Instant::now(), 0, 0.0);
    for group in groups(&proofs) {
        eprintln!(
            "{}, {}, limit {} s:",
            group[0].package,
            group[0].solver,
            limit_s(group[0])
        );
        let (judged, cbmc) = prove(&group, &root)?;
        for one in &judged {
            println!("{}", line(one));
            proven += usize::from(one.verdict.is_ok());
            solver_s += one.verdict.as_ref().map_or(0.0, |proven| proven.seconds);
        }
        // The verdicts are recorded after each group, so that an interrupted run keeps them.
        if let Some(commit) = &commit {
            let run = Run {
                commit: commit.clone(),
                date: output("date", &["-u", "+%F"])?,
                kani: kani.clone(),
                cbmc: cbmc.unwrap_or_else(|| "unknown".to_owned()),
                machine: machine(),
                sources: ledger.fingerprints(&root)?,
            };
            record(&ledger, run, judged)?;
        }
    }
    let wall_s = begin.elapsed().as_secs_f64();
    println!(
        "{proven} of {} proven in {wall_s:.0} s by the clock: {solver_s:.0} s in harnesses that \
         were proven, the rest in compilation and in harnesses that were not",
        proofs.len()
    );
    Ok(proven == proofs.len())
}

/// Proofs that one call of Kani can check with one compilation: same package, solver, flags and
/// limit.
pub fn groups(proofs: &[Proof]) -> Vec<Vec<&Proof>> {
    let mut groups: Vec<Vec<&Proof>> = Vec::new();
    for proof in proofs {
        let same = |group: &&mut Vec<&Proof>| {
            let first = group[0];
            first.package == proof.package
                && first.solver == proof.solver
                && first.flags == proof.flags
                && limit_s(first) == limit_s(proof)
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.push(proof),
            None => groups.push(vec![proof]),
        }
    }
    groups
}

/// The ledger's limit, rounded up to a minute times a power of two, so that few distinct limits
/// occur.
fn limit_s(proof: &Proof) -> u64 {
    60 * proof.time_limit_s().div_ceil(60).next_power_of_two()
}

/// The arguments with which cargo checks a group.
fn arguments(group: &[&Proof]) -> Vec<String> {
    let first = group[0];
    let mut arguments = vec!["kani".to_owned(), "-p".to_owned(), first.package.clone()];
    for proof in group {
        arguments.extend(["--harness".to_owned(), proof.harness.clone()]);
    }
    let limit = format!("{}s", limit_s(first));
    let solver = first.solver.to_string();
    let common = [
        "--exact",
        "-Z",
        "function-contracts",
        "-Z",
        "stubbing",
        "-Z",
        "unstable-options",
        "--harness-timeout",
        &limit,
        "--solver",
        &solver,
        "--output-format",
        "regular",
    ];
    arguments.extend(common.map(str::to_owned));
    arguments.extend(first.flags.iter().cloned());
    arguments
}

/// Runs one group of the workspace at `root`; also returns the version of CBMC.
pub fn prove(group: &[&Proof], root: &Path) -> Result<(Vec<Judged>, Option<String>), String> {
    let mut command = Command::new("cargo");
    command
        .current_dir(root)
        // Kani brings its own compiler, so the toolchain of this task is not passed on.
        .env_remove("RUSTUP_TOOLCHAIN")
        .env_remove("RUSTC")
        .args(arguments(group));
    let limits_s: u64 = group.iter().map(|proof| limit_s(proof)).sum();
    let finished = process::run(&mut command, Duration::from_secs(limits_s + BUILD_S))?;
    let stopped = finished.timed_out.then_some(finished.elapsed.as_secs());
    Ok((
        judge(group, &finished.output, stopped),
        kani_output::cbmc_version(&finished.output),
    ))
}

/// The result of each proof in the output of one call; `stopped_s` is set where the call was
/// stopped.
fn judge(group: &[&Proof], output: &str, stopped_s: Option<u64>) -> Vec<Judged> {
    let reports = HarnessReport::parse_all(output);
    let mut judged = Vec::new();
    for proof in group {
        let report = reports
            .iter()
            .find(|report| report.harness == proof.harness);
        let verdict = match (report, stopped_s) {
            (Some(report), _) => report.accept(proof.covers),
            (None, Some(seconds)) => Err(format!("not reached: stopped after {seconds} s")),
            (None, None) => Err(explain(output)),
        };
        judged.push(Judged {
            proof: (*proof).clone(),
            verdict,
            solver: report.and_then(|report| report.solver.clone()),
        });
    }
    judged
}

/// The reason why a harness was not run: the compiler's first error.
fn explain(output: &str) -> String {
    let error = output.lines().find(|line| line.starts_with("error"));
    format!(
        "Kani did not run the harness; {}",
        error.unwrap_or("it gave no error")
    )
}

fn line(judged: &Judged) -> String {
    let name = &judged.proof.harness;
    let solver = judged.solver.as_deref().unwrap_or("no solver");
    match &judged.verdict {
        Ok(p) => format!(
            "{} {name}: proven, {} checks ({} unreachable), {} covers, {:.1} s, {solver}",
            judged.proof.id, p.checks, p.unreachable, p.covers, p.seconds
        ),
        Err(why) => format!("{} {name}: NOT PROVEN, {why}, {solver}", judged.proof.id),
    }
}

/// Writes the verdicts into `results.toml` and regenerates the page.
fn record(ledger: &Ledger, run: Run, judged: Vec<Judged>) -> Result<(), String> {
    let mut results = Results::read()?;
    let now = run.sources.clone();
    let outcomes = judged
        .into_iter()
        .map(|one| outcome(one, &run.commit))
        .collect();
    results.record(run, outcomes);
    results.prune(ledger);
    results.write()?;
    let page = jcas_ledger::page(ledger, &results, &now);
    jcas_ledger::write(&workspace_root().join("verification/RESULTS.md"), &page)
}

fn outcome(judged: Judged, commit: &str) -> Outcome {
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
        mended: None,
        note: None,
    };
    match judged.verdict {
        Ok(proven) => {
            outcome.checks = u32::try_from(proven.checks).ok();
            outcome.covers = u32::try_from(proven.covers).ok();
            outcome.seconds = Some(proven.seconds);
            outcome.note = other_solver(asked, outcome.solver.as_deref());
        }
        Err(why) => {
            outcome.verdict = match why.as_str() {
                "CBMC timed out" => ProofVerdict::NotSolved,
                why if why.starts_with("not reached") => ProofVerdict::Unfinished,
                _ => ProofVerdict::Failed,
            };
            outcome.note = Some(why);
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

/// Returns Kani's version, or an error with the installation command where Kani is missing.
pub fn require_kani() -> Result<String, String> {
    output("cargo", &["kani", "--version"])
        .map(|version| version.trim_start_matches("cargo-kani ").to_owned())
        .map_err(|_| {
            "Kani is not installed: `cargo install --locked kani-verifier --version 0.67.0 \
             && cargo kani setup`.\nWithout it, `cargo test` runs every harness on random \
             inputs, which is a test and not a proof."
                .to_owned()
        })
}

/// The abbreviated commit, or `None` where the ledger or a source has uncommitted changes.
fn clean_commit(root: &Path, ledger: &Ledger) -> Result<Option<String>, String> {
    let root = root.to_string_lossy();
    let mut arguments = vec!["-C", &root, "status", "--porcelain", "--"];
    arguments.push("verification/proofs.toml");
    arguments.extend(ledger.sources.values().flatten().map(String::as_str));
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
fn output(program: &str, arguments: &[&str]) -> Result<String, String> {
    let run = Command::new(program).args(arguments).output();
    let run = run.map_err(|error| format!("cannot start {program}: {error}"))?;
    if !run.status.success() {
        return Err(String::from_utf8_lossy(&run.stderr).into_owned());
    }
    let text = String::from_utf8_lossy(&run.stdout);
    Ok(text.lines().next().unwrap_or_default().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kani_output::tests::{PROVEN, TIMED_OUT};

    fn proof(name: &str) -> Proof {
        let ledger = Ledger::read().unwrap();
        let mut proof = ledger.proof[0].clone();
        proof.harness = format!("proofs::energy::{name}");
        proof.covers = 1;
        proof
    }

    fn outcome_of(output: &str, stopped_s: Option<u64>) -> Outcome {
        let proof = proof("the_ledger_balances");
        let mut judged = judge(&[&proof], output, stopped_s);
        outcome(judged.remove(0), "0123456")
    }

    /// Catches a verdict that is recorded as better than Kani's output is.
    #[test]
    fn outcomes_are_what_kani_printed() {
        let proven = outcome_of(PROVEN, None);
        assert_eq!(proven.verdict, ProofVerdict::Verified);
        assert_eq!((proven.checks, proven.covers), (Some(3), Some(1)));
        assert_eq!(proven.seconds, Some(0.8153));
        assert_eq!(
            proven.solver.as_deref(),
            Some("MiniSAT 2.2.1 with simplifier")
        );
        assert_eq!(proven.note.as_deref(), Some("cadical was asked for"));
        assert_eq!(outcome_of(TIMED_OUT, None).verdict, ProofVerdict::NotSolved);
        assert_eq!(outcome_of("", Some(9)).verdict, ProofVerdict::Unfinished);
        let broken = outcome_of("error[E0425]: no such name\n", None);
        assert_eq!(broken.verdict, ProofVerdict::Failed);
        assert!(broken.note.unwrap().contains("E0425"));
        let failed = PROVEN.replace("Status: SUCCESS", "Status: FAILURE");
        assert_eq!(outcome_of(&failed, None).verdict, ProofVerdict::Failed);
    }

    /// Catches a group whose harnesses are confused with each other.
    #[test]
    fn each_harness_of_a_call_is_judged_by_itself() {
        let (one, other, third) = (proof("the_ledger_balances"), proof("late"), proof("never"));
        let late = TIMED_OUT.replace("the_ledger_balances", "late");
        let output = format!("{PROVEN}{late}");
        let judged = judge(&[&one, &other, &third], &output, None);
        assert!(judged[0].verdict.is_ok());
        assert_eq!(judged[1].verdict.as_ref().unwrap_err(), "CBMC timed out");
        assert!(
            judged[2]
                .verdict
                .as_ref()
                .unwrap_err()
                .contains("did not run")
        );
    }

    #[test]
    fn proofs_of_one_call_share_all_that_the_call_fixes() {
        let proofs = Ledger::read().unwrap().proof;
        let groups = groups(&proofs);
        assert_eq!(groups.iter().map(Vec::len).sum::<usize>(), proofs.len());
        for group in &groups {
            let first = group[0];
            assert!(group.iter().all(|proof| proof.flags == first.flags));
            assert!(
                group
                    .iter()
                    .all(|proof| limit_s(proof) >= proof.time_limit_s())
            );
            let line = arguments(group).join(" ");
            assert!(
                line.contains(&format!("--solver {}", first.solver)),
                "{line}"
            );
            assert_eq!(line.matches("--harness proofs::").count(), group.len());
        }
        assert!(groups.len() < proofs.len() / 2, "{} calls", groups.len());
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
