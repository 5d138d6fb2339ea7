//! `proofs.toml`, `ASSUMPTIONS.md` and `README.md` against the sources.
//!
//! Catches a harness that no ledger lists, a row whose harness is gone, and a mutant that no longer
//! fits its file. Catches a stub or a loop bound that nobody declared.

use jcas_ledger::{Ledger, Mutant, Proof, Results, Sources};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// A harness as it stands in the sources.
struct Harness {
    package: &'static str,
    path: String,
    attributes: String,
    body: String,
    /// `(cases, covers)` of its twin, from the list at the end of the file.
    twin: Option<(usize, usize)>,
}

impl Harness {
    fn name(&self) -> &str {
        self.path.rsplit("::").next().unwrap()
    }

    /// What the attribute `kani::<name>(...)` holds, each time it occurs.
    fn attribute(&self, name: &str) -> Vec<String> {
        let open = format!("kani::{name}(");
        let mut found = Vec::new();
        for part in self.attributes.split(&open).skip(1) {
            found.push(part.split(')').next().unwrap().trim().to_owned());
        }
        found
    }
}

fn root() -> PathBuf {
    jcas_ledger::workspace_root()
}

fn read(path: &str) -> String {
    jcas_ledger::read(&root().join(path)).unwrap()
}

fn ledger() -> Vec<Proof> {
    Ledger::read().unwrap().proof
}

/// Compares a generated document with its file; under `JCAS_BLESS` writes it first.
fn is_fresh(path: &str, fresh: &str) {
    if std::env::var_os("JCAS_BLESS").is_some() {
        jcas_ledger::write(&root().join(path), fresh).unwrap();
    }
    assert!(
        read(path) == fresh,
        "{path} is stale: run `JCAS_BLESS=1 cargo test -p jcas-verification --test ledger`"
    );
}

/// Every function of the proof folders that carries a Kani proof attribute.
fn harnesses() -> Vec<Harness> {
    let mut found = Vec::new();
    let folders = [
        ("jcas-core", "core/src/proofs"),
        ("jcas-ffi", "ffi/src/proofs"),
        ("jcas-policy", "policy/src/proofs"),
        ("jcas-verification", "verification/src/proofs"),
    ];
    for (package, folder) in folders {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let module = path.file_stem().unwrap().to_str().unwrap().to_owned();
            let text = std::fs::read_to_string(&path).unwrap();
            read_harnesses(package, &module, &text, &mut found);
        }
    }
    assert!(found.len() > 20, "only {} harnesses found", found.len());
    found
}

fn read_harnesses(package: &'static str, module: &str, text: &str, found: &mut Vec<Harness>) {
    for (position, _) in text.match_indices("\npub fn ") {
        let above = text[..position].rfind("\n\n").map_or(0, |blank| blank + 2);
        let attributes = &text[above..position];
        if !attributes.contains("kani::proof") {
            continue;
        }
        let body = text[position + 1..].split("\n}\n").next().unwrap();
        let name = body["pub fn ".len()..].split('(').next().unwrap();
        found.push(Harness {
            package,
            path: format!("proofs::{module}::{name}"),
            attributes: attributes.to_owned(),
            body: body.to_owned(),
            twin: twin(text, name),
        });
    }
}

/// Reads `name: 256 cases, 2 covers;`.
fn twin(text: &str, name: &str) -> Option<(usize, usize)> {
    let row = text
        .lines()
        .find_map(|line| line.trim().strip_prefix(&format!("{name}: ")))?;
    let (cases, covers) = row.trim_end_matches(';').split_once(", ")?;
    let number = |words: &str| words.split(' ').next()?.parse().ok();
    Some((number(cases)?, number(covers)?))
}

/// The first cells of the rows of the Markdown tables below a heading.
fn rows(text: &str, heading: &str) -> Vec<Vec<String>> {
    let section = text
        .split(heading)
        .nth(1)
        .unwrap_or_else(|| panic!("no `{heading}`"));
    let section = section.split("\n## ").next().unwrap();
    let lines = section.lines().filter(|line| line.starts_with('|'));
    let cells = |line: &str| {
        let inner = line.trim_matches('|');
        inner
            .split(" | ")
            .map(|cell| cell.trim().to_owned())
            .collect()
    };
    lines.skip(2).map(cells).collect()
}

#[test]
fn the_ledger_lists_exactly_the_harnesses_of_the_sources() {
    let listed: BTreeSet<_> = ledger()
        .into_iter()
        .map(|proof| (proof.package, proof.harness))
        .collect();
    let written: BTreeSet<_> = harnesses()
        .into_iter()
        .map(|harness| (harness.package.to_owned(), harness.path))
        .collect();
    assert_eq!(listed, written);
    assert_eq!(listed.len(), ledger().len(), "a harness is listed twice");
}

#[test]
fn covers_and_twins_are_those_of_the_sources() {
    let proofs: BTreeMap<_, _> = ledger()
        .into_iter()
        .map(|proof| (proof.harness.clone(), proof))
        .collect();
    for harness in harnesses() {
        let name = harness.name();
        let proof = &proofs[&harness.path];
        let covers = harness.body.matches("kani::cover!(").count();
        assert_eq!(proof.covers as usize, covers, "{name}");
        assert!(covers > 0, "{name} shows no reachable case");
        let (cases, in_twin) = harness.twin.unwrap_or_else(|| panic!("{name} has no twin"));
        assert_eq!(in_twin, covers, "{name}");
        assert!(cases >= 100, "{name}");
        assert!(
            harness.body.lines().count() < 40,
            "{name} is too long to read at once"
        );
    }
}

#[test]
fn every_property_is_claimed() {
    let ids: BTreeSet<_> = ledger().into_iter().map(|proof| proof.id).collect();
    for number in 1..=14 {
        assert!(ids.contains(&format!("P{number}")), "no proof of P{number}");
    }
    for proof in ledger() {
        assert!(
            proof.claim.ends_with('.') && !proof.bound.is_empty(),
            "{}",
            proof.harness
        );
    }
}

#[test]
fn every_mutant_is_one_edit_of_its_file() {
    for proof in ledger() {
        let text = read(&proof.mutant.file);
        let places = text.matches(&proof.mutant.find).count();
        assert_eq!(places, 1, "{}: `{}`", proof.harness, proof.mutant.find);
        assert_ne!(proof.mutant.find, proof.mutant.replace, "{}", proof.harness);
    }
}

#[test]
fn assumptions_are_declared_and_used() {
    let page = read("verification/ASSUMPTIONS.md");
    let declared: BTreeSet<_> = rows(&page, "## Assumptions")
        .into_iter()
        .map(|row| row[0].clone())
        .collect();
    let used: BTreeSet<_> = ledger()
        .into_iter()
        .flat_map(|proof| proof.assumptions)
        .collect();
    assert_eq!(declared, used);
}

#[test]
fn every_stub_is_an_assumption_of_its_proof() {
    let page = read("verification/ASSUMPTIONS.md");
    let rows = rows(&page, "## Assumptions");
    let proofs: BTreeMap<_, _> = ledger()
        .into_iter()
        .map(|proof| (proof.harness.clone(), proof))
        .collect();
    for harness in harnesses() {
        let mut stubbed = harness.attribute("stub_verified");
        for pair in harness.attribute("stub") {
            stubbed.push(pair.split(',').next().unwrap().to_owned());
        }
        for function in stubbed {
            // Two proofs may stub one function differently: each stub has a row.
            let quoted = format!("`{function}`");
            let stubs: Vec<_> = rows.iter().filter(|row| row[1].contains(&quoted)).collect();
            assert!(
                !stubs.is_empty(),
                "ASSUMPTIONS.md has no row for {function}"
            );
            let declared = &proofs[&harness.path].assumptions;
            assert!(
                stubs.iter().any(|row| declared.contains(&row[0])),
                "{} stubs {function}",
                harness.path
            );
        }
    }
}

#[test]
fn loop_bounds_are_those_of_the_sources() {
    let page = read("verification/ASSUMPTIONS.md");
    let declared: BTreeMap<_, _> = rows(&page, "## Loop bounds")
        .into_iter()
        .map(|row| (row[0].trim_matches('`').to_owned(), row[1].clone()))
        .collect();
    let mut written = BTreeMap::new();
    for harness in harnesses() {
        if let Some(bound) = harness.attribute("unwind").first() {
            written.insert(harness.name().to_owned(), bound.clone());
        }
    }
    assert_eq!(declared, written);
}

#[test]
fn flags_are_declared() {
    let page = read("verification/ASSUMPTIONS.md");
    let declared: BTreeMap<_, _> = rows(&page, "## Flags")
        .into_iter()
        .map(|row| {
            let word = |cell: &str| cell.trim_matches('`').to_owned();
            (word(&row[0]), word(&row[1]))
        })
        .collect();
    let mut listed = BTreeMap::new();
    for proof in ledger() {
        if !proof.flags.is_empty() {
            let name = proof.harness.rsplit("::").next().unwrap().to_owned();
            listed.insert(name, proof.flags.join(" "));
        }
    }
    assert_eq!(declared, listed);
}

#[test]
fn the_readme_tells_why_each_proof_is_within_reach() {
    let page = read("verification/README.md");
    let told: BTreeSet<_> = rows(&page, "## Within reach")
        .into_iter()
        .map(|row| row[0].trim_matches('`').to_owned())
        .collect();
    let written: BTreeSet<_> = harnesses()
        .into_iter()
        .map(|harness| harness.name().to_owned())
        .collect();
    assert_eq!(told, written);
}

/// `PROOFS.md` is the ledger as a person reads it.
#[test]
fn the_table_of_proofs_is_fresh() {
    is_fresh("verification/PROOFS.md", &table(&ledger()));
}

/// `RESULTS.md` says which harnesses have been run, and whether their sources have changed since.
#[test]
fn the_page_of_results_is_fresh() {
    let (ledger, mut results) = (Ledger::read().unwrap(), Results::read().unwrap());
    results.prune(&ledger);
    is_fresh("verification/results.toml", &results.to_text().unwrap());
    let now = Sources::read(&root(), &ledger).unwrap();
    let page = jcas_ledger::page(&ledger, &results, &now);
    is_fresh("verification/RESULTS.md", &page);
    let summary = jcas_ledger::summary(&ledger, &results, &now);
    print!("{summary}");
    for proof in &ledger.proof {
        if !results.is_current(proof, &now) {
            println!("not verified on these sources: {}", proof.harness);
        }
    }
    for path in ["docs/trust.md", "verification/README.md"] {
        let document = jcas_ledger::replace_summary(&read(path), &summary);
        is_fresh(
            path,
            &document.unwrap_or_else(|| panic!("{path} does not quote the verdicts")),
        );
    }
    // The front page may quote the counts.
    if let Some(document) = jcas_ledger::replace_summary(&read("README.md"), &summary) {
        is_fresh("README.md", &document);
    }
}

/// A result that is recorded is one of the ledger's, and never better than the ledger allows.
#[test]
fn results_are_of_the_ledgers_harnesses() {
    let results = Results::read().unwrap();
    for proof in ledger() {
        let Some(outcome) = results.of(&proof) else {
            continue;
        };
        let run = results.run.iter().find(|run| run.commit == outcome.commit);
        assert!(
            run.is_some(),
            "{}: no run of {}",
            proof.harness,
            outcome.commit
        );
        assert!(outcome.covers.is_none_or(|covers| covers <= proof.covers));
    }
}

fn table(proofs: &[Proof]) -> String {
    let mut text = String::from(
        "# The proofs\n\nWritten from `proofs.toml`; each row is one harness.\n\n\
         | id | harness | claim | for | rests on | a fault that it notices |\n\
         | --- | --- | --- | --- | --- | --- |\n",
    );
    for proof in proofs {
        let name = proof.harness.rsplit("::").next().unwrap();
        let rests = if proof.assumptions.is_empty() {
            "nothing".to_owned()
        } else {
            proof.assumptions.join(", ")
        };
        text.push_str(&format!(
            "| {} | `{name}` | {} | {} | {rests} | {} |\n",
            proof.id,
            proof.claim,
            proof.bound,
            fault(&proof.mutant),
        ));
    }
    text
}

/// The edit in one line.
fn fault(mutant: &Mutant) -> String {
    let line = |text: &str| {
        let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
        format!("`{}`", words.replace('|', "\\|"))
    };
    if mutant.replace.is_empty() {
        format!("{} left out", line(&mutant.find))
    } else {
        format!(
            "{} in place of {}",
            line(&mutant.replace),
            line(&mutant.find)
        )
    }
}
