//! `verification/RESULTS.md`, and the sentences that other documents quote from it.

use crate::{Ledger, Outcome, Proof, ProofVerdict, Results, Sources};

/// Marks around the summary in a document that quotes it.
const BEGIN: &str =
    "<!-- verdicts: written by `JCAS_BLESS=1 cargo test -p jcas-verification` -->\n";
const END: &str = "<!-- end of verdicts -->";

/// The whole page; `now` holds the present sources.
pub fn page(ledger: &Ledger, results: &Results, now: &Sources) -> String {
    let mut text = String::from(
        "# Verdicts of the model checker\n\n\
         Written by `cargo xtask prove` from `results.toml`.\n\
         Each row is the newest run of one harness.\n\
         A harness counts as verified if every check holds and every cover is reached.\n\
         The sources of a row are the files that the checked program contains, and those that \
         they\n\
         import, comments aside. Where they have changed, the verdict is that of the \
         commit alone.\n\
         The mutant is the deliberate fault of PROOFS.md, under Kani.\n\n",
    );
    text += &summary(ledger, results, now);
    text +=
        "\n## Runs\n\n| commit | date | Kani | CBMC | machine |\n| --- | --- | --- | --- | --- |\n";
    for run in &results.run {
        text += &format!(
            "| {} | {} | {} | {} | {} |\n",
            run.commit, run.date, run.kani, run.cbmc, run.machine
        );
    }
    text += "\n## Harnesses\n\n\
             | id | harness | verdict | covers | checks | seconds | solver | commit | \
             sources since | mutant |\n\
             | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for proof in &ledger.proof {
        text += &row(proof, results, now);
    }
    text
}

fn row(proof: &Proof, results: &Results, now: &Sources) -> String {
    let name = proof.harness.trim_start_matches("proofs::");
    let head = format!("| {} | `{name}` |", proof.id);
    let Some(outcome) = results.of(proof) else {
        return format!("{head} not run yet | | | | {} | | | |\n", proof.solver);
    };
    let number = |value: Option<u32>| value.map_or_else(String::new, |n| n.to_string());
    let covers = match outcome.covers {
        Some(reached) => format!("{reached} of {}", proof.covers),
        None => String::new(),
    };
    let since = if outcome.is_of(now) {
        "unchanged"
    } else {
        "changed"
    };
    format!(
        "{head} {} | {covers} | {} | {} | {} | {} | {since} | {} |\n",
        verdict(outcome),
        number(outcome.checks),
        outcome
            .seconds
            .map_or_else(String::new, |seconds| format!("{seconds:.0}")),
        outcome.solver.as_deref().unwrap_or(""),
        outcome.commit,
        outcome
            .mutant
            .as_deref()
            .unwrap_or("not run")
            .replace('|', "/"),
    )
}

/// The verdict with its note.
fn verdict(outcome: &Outcome) -> String {
    let word = |verdict| match verdict {
        ProofVerdict::Verified => "verified",
        ProofVerdict::Failed => "**failed**",
        ProofVerdict::NotSolved => "**not solved**",
        ProofVerdict::Unfinished => "not run to its end",
    };
    let mut text = word(outcome.verdict).to_owned();
    if let Some(note) = &outcome.note {
        text += &format!(": {}", note.replace('|', "/"));
    }
    text
}

/// How many harnesses are verified, and in what time.
pub fn summary(ledger: &Ledger, results: &Results, now: &Sources) -> String {
    let (mut current, mut older, mut seconds) = (0, 0, 0.0);
    for proof in &ledger.proof {
        let verified = |row: &&Outcome| row.verdict == ProofVerdict::Verified;
        if let Some(row) = results.of(proof).filter(verified) {
            if row.is_of(now) {
                current += 1;
                seconds += row.seconds.unwrap_or(0.0);
            } else {
                older += 1;
            }
        }
    }
    let all = ledger.proof.len();
    let count = if current == all {
        format!("All {all} harnesses are verified under Kani on these sources.")
    } else {
        format!(
            "{current} of {all} harnesses are verified under Kani on these sources, {older} more \
             on older ones."
        )
    };
    let minutes = (seconds / 60.0).ceil();
    let unit = if minutes == 1.0 { "minute" } else { "minutes" };
    format!(
        "{count}\n\
         Every check of each holds, and every cover is reached.\n\
         Together they took {minutes:.0} {unit} by the clock of a busy machine.\n",
    )
}

/// A document with the summary between its marks; none if it has no marks.
pub fn replace_summary(document: &str, summary: &str) -> Option<String> {
    let (before, rest) = document.split_once(BEGIN)?;
    let (_, after) = rest.split_once(END)?;
    Some(format!("{before}{BEGIN}{summary}{END}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Run;

    fn ledger() -> Ledger {
        let row = |name: &str| {
            format!(
                "[[proof]]\nid = \"P1\"\npackage = \"a\"\n\
                 harness = \"proofs::m::{name}\"\nclaim = \"c\"\nbound = \"b\"\n\
                 assumptions = []\ncovers = 2\n\
                 [proof.mutant]\nfile = \"f\"\nfind = \"x\"\nreplace = \"y\"\n"
            )
        };
        let rows = [row("one"), row("two"), row("new")].concat();
        toml::from_str(&format!("sources = [\"core/src\"]\n{rows}")).unwrap()
    }

    fn sources() -> Sources {
        Sources::read(&crate::workspace_root(), &ledger()).unwrap()
    }

    fn outcome(name: &str, verdict: ProofVerdict) -> Outcome {
        let files = vec!["core/src/rules/energy.rs".to_owned()];
        Outcome {
            package: "a".into(),
            harness: format!("proofs::m::{name}"),
            commit: "0123456".into(),
            verdict,
            checks: Some(7),
            covers: Some(2),
            seconds: Some(90.0),
            solver: None,
            mutant: None,
            note: Some("a | b".into()),
            sources: sources().fingerprint(&files).unwrap(),
            files,
        }
    }

    fn results(outcomes: Vec<Outcome>) -> Results {
        let mut results = Results::default();
        let run = Run {
            commit: "0123456".into(),
            date: "2026-11-24".into(),
            kani: "0.67.0".into(),
            cbmc: "6.6.0".into(),
            machine: "2 processors".into(),
        };
        results.record(run, outcomes);
        results
    }

    /// Catches a page that hides a change, a harness that was never run, or one that is gone.
    #[test]
    fn the_page_tells_what_has_changed_and_what_is_missing() {
        let mut old = outcome("two", ProofVerdict::Verified);
        old.sources = "0".into();
        let mut results = results(vec![
            outcome("one", ProofVerdict::Verified),
            old,
            outcome("new", ProofVerdict::Failed),
            outcome("gone", ProofVerdict::Verified),
        ]);
        let (ledger, now) = (ledger(), sources());
        let page = page(&ledger, &results, &now);
        let row = |name: &str| {
            page.lines()
                .find(|line| line.contains(&format!("`m::{name}`")))
        };
        assert!(
            row("one")
                .unwrap()
                .ends_with("| 0123456 | unchanged | not run |")
        );
        assert!(
            row("two")
                .unwrap()
                .ends_with("| 0123456 | changed | not run |")
        );
        assert!(row("new").unwrap().contains("**failed**: a / b"));
        assert!(row("gone").is_none());
        let told = summary(&ledger, &results, &now);
        assert!(
            told.contains("on these sources, 1 more on older ones."),
            "{told}"
        );
        assert!(told.contains("took 2 minutes"), "{told}");
        results.outcome[0].seconds = Some(30.0);
        let told = summary(&ledger, &results, &now);
        assert!(told.contains("took 1 minute by"), "{told}");
        results.prune(&ledger);
        assert_eq!(results.outcome.len(), 3);
    }

    #[test]
    fn a_newer_outcome_takes_the_place_of_an_older_one() {
        let mut results = results(vec![outcome("one", ProofVerdict::Verified)]);
        let mut run = results.run[0].clone();
        run.commit = "89abcde".into();
        let mut newer = outcome("one", ProofVerdict::NotSolved);
        newer.commit.clone_from(&run.commit);
        results.record(run, vec![newer]);
        results.prune(&ledger());
        assert_eq!(results.outcome.len(), 1);
        assert_eq!(results.outcome[0].verdict, ProofVerdict::NotSolved);
        assert_eq!(results.run.len(), 1, "a run without an outcome stays");
        let again: Results = toml::from_str(&results.to_text().unwrap()).unwrap();
        assert_eq!(again.to_text().unwrap(), results.to_text().unwrap());
    }

    #[test]
    fn only_what_stands_between_the_marks_is_replaced() {
        let document = format!("before\n{BEGIN}old\n{END}\nafter\n");
        let fresh = replace_summary(&document, "new\n").unwrap();
        assert_eq!(fresh, format!("before\n{BEGIN}new\n{END}\nafter\n"));
        assert!(replace_summary("no marks", "new\n").is_none());
    }
}
