//! `verification/RESULTS.md`, and the sentences that other documents quote from it.

use crate::{Ledger, Outcome, Proof, ProofVerdict, Results};
use std::collections::BTreeMap;

/// Marks around the summary in a document that quotes it.
const BEGIN: &str =
    "<!-- verdicts: written by `JCAS_BLESS=1 cargo test -p jcas-verification` -->\n";
const END: &str = "<!-- end of verdicts -->";

/// The whole page; `now` holds the fingerprints of the present sources.
pub fn page(ledger: &Ledger, results: &Results, now: &BTreeMap<String, String>) -> String {
    let mut text = String::from(
        "# Verdicts of the model checker\n\n\
         Written by `cargo xtask prove` from `results.toml`.\n\
         Each row is the newest run of one harness.\n\
         A harness counts as verified if every check holds and every cover is reached.\n\
         The last column compares the sources of the run with the present ones, comments aside:\n\
         after a change the verdict is that of the commit, and not of the present code.\n\n",
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
             sources since |\n\
             | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for proof in &ledger.proof {
        text += &row(proof, results, now);
    }
    text
}

fn row(proof: &Proof, results: &Results, now: &BTreeMap<String, String>) -> String {
    let name = proof.harness.trim_start_matches("proofs::");
    let head = format!("| {} | `{name}` |", proof.id);
    let Some(outcome) = results.of(proof) else {
        return format!("{head} not run yet | | | | {} | | |\n", proof.solver);
    };
    let number = |value: Option<u32>| value.map_or_else(String::new, |n| n.to_string());
    let covers = match outcome.covers {
        Some(reached) => format!("{reached} of {}", proof.covers),
        None => String::new(),
    };
    let since = if results.is_current(outcome, now) {
        "unchanged"
    } else {
        "changed"
    };
    format!(
        "{head} {} | {covers} | {} | {} | {} | {} | {since} |\n",
        verdict(outcome),
        number(outcome.checks),
        outcome
            .seconds
            .map_or_else(String::new, |seconds| format!("{seconds:.0}")),
        outcome.solver.as_deref().unwrap_or(""),
        outcome.commit,
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
    if let Some(mended) = outcome.mended {
        text += &format!("; after a mend of the harness {}", word(mended));
    }
    if let Some(note) = &outcome.note {
        text += &format!(": {}", note.replace('|', "/"));
    }
    text
}

/// The counts, in sentences.
pub fn summary(ledger: &Ledger, results: &Results, now: &BTreeMap<String, String>) -> String {
    let count = |wanted: &dyn Fn(&Outcome) -> bool| {
        let outcomes = ledger.proof.iter().filter_map(|proof| results.of(proof));
        outcomes.filter(|outcome| wanted(outcome)).count()
    };
    let verdicts = |wanted| count(&|outcome| outcome.mended.is_none() && outcome.verdict == wanted);
    let verified = verdicts(ProofVerdict::Verified);
    let mended = count(&|outcome| outcome.mended == Some(ProofVerdict::Verified));
    let unchanged = count(&|o| o.verdict == ProofVerdict::Verified && results.is_current(o, now));
    let missing = ledger.proof.len() - count(&|_| true);
    format!(
        "Of {} harnesses, {verified} verified as they stood and {mended} more after a mend of the \
         harness.\n\
         {} failed, {} were not solved in their time, {} were not run to their end, {missing} have \
         not been run yet.\n\
         Of the {verified}, {unchanged} were run on the present sources; the others on older \
         ones.\n",
        ledger.proof.len(),
        verdicts(ProofVerdict::Failed),
        verdicts(ProofVerdict::NotSolved),
        verdicts(ProofVerdict::Unfinished),
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
        let text = format!(
            "[sources]\na = [\"a\"]\n{}{}{}",
            row("one"),
            row("two"),
            row("new")
        );
        toml::from_str(&text).unwrap()
    }

    fn outcome(name: &str, verdict: ProofVerdict) -> Outcome {
        Outcome {
            package: "a".into(),
            harness: format!("proofs::m::{name}"),
            commit: "0123456".into(),
            verdict,
            checks: Some(7),
            covers: Some(2),
            seconds: Some(1.5),
            solver: None,
            mended: None,
            note: Some("a | b".into()),
        }
    }

    fn sources(hash: &str) -> BTreeMap<String, String> {
        BTreeMap::from([("a".to_owned(), hash.to_owned())])
    }

    fn results(outcomes: Vec<Outcome>) -> Results {
        let mut results = Results::default();
        let run = Run {
            commit: "0123456".into(),
            date: "2026-11-24".into(),
            kani: "0.67.0".into(),
            cbmc: "6.6.0".into(),
            machine: "2 processors".into(),
            sources: sources("then"),
        };
        results.record(run, outcomes);
        results
    }

    /// Catches a page that hides a change, a harness that was never run, or one that is gone.
    #[test]
    fn the_page_tells_what_has_changed_and_what_is_missing() {
        let outcomes = vec![
            outcome("one", ProofVerdict::Verified),
            outcome("two", ProofVerdict::Failed),
            outcome("gone", ProofVerdict::Verified),
        ];
        let (ledger, mut results) = (ledger(), results(outcomes));
        let row = |name: &str, now: &str| {
            let page = page(&ledger, &results, &sources(now));
            let found = page
                .lines()
                .find(|line| line.contains(&format!("`m::{name}`")));
            found.map(str::to_owned)
        };
        assert!(
            row("one", "then")
                .unwrap()
                .ends_with("| 0123456 | unchanged |")
        );
        assert!(
            row("one", "now")
                .unwrap()
                .ends_with("| 0123456 | changed |")
        );
        assert!(row("two", "then").unwrap().contains("**failed**: a / b"));
        assert!(row("new", "then").unwrap().contains("not run yet"));
        assert!(row("gone", "then").is_none());
        let told = summary(&ledger, &results, &sources("now"));
        assert!(told.starts_with("Of 3 harnesses, 1 verified as they stood and 0 more"));
        assert!(told.contains("1 failed, 0 were not solved"));
        assert!(told.contains("Of the 1, 0 were run on the present sources"));
        results.prune(&ledger);
        assert_eq!(results.outcome.len(), 2);
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
        assert_eq!(again.to_text(), results.to_text());
    }

    #[test]
    fn only_what_stands_between_the_marks_is_replaced() {
        let document = format!("before\n{BEGIN}old\n{END}\nafter\n");
        let fresh = replace_summary(&document, "new\n").unwrap();
        assert_eq!(fresh, format!("before\n{BEGIN}new\n{END}\nafter\n"));
        assert!(replace_summary("no marks", "new\n").is_none());
    }
}
