//! Reads what `cargo kani --export-json` writes.
//!
//! Kani's own verdict is not enough: it also says Success when a cover property is unsatisfiable or
//! when every assertion is unreachable. This module therefore derives the verdict from the single
//! checks.

use crate::error::Error;
use jcas_ledger::ProofVerdict;
use serde::Deserialize;

/// The export of one call, which may have checked many harnesses.
#[derive(Debug, Deserialize)]
pub struct Export {
    tools: Tools,
    harness_metadata: Vec<Metadata>,
    error_details: Vec<Exit>,
    verification_results: Results,
}

#[derive(Debug, Deserialize)]
struct Tools {
    kani: String,
    cbmc: Option<String>,
}

#[derive(Debug, Deserialize)]
struct Metadata {
    pretty_name: String,
    goto_file: Option<String>,
}

#[derive(Debug, Deserialize)]
struct Exit {
    harness_id: String,
    exit_status: Option<String>,
}

#[derive(Debug, Deserialize)]
struct Results {
    results: Vec<Report>,
}

#[derive(Debug, Deserialize)]
struct Report {
    harness_id: String,
    status: String,
    duration_ms: u64,
    checks: Vec<Check>,
}

#[derive(Debug, Deserialize)]
struct Check {
    function: String,
    status: String,
    description: String,
    location: Location,
    category: String,
}

#[derive(Debug, Deserialize, PartialEq)]
struct Location {
    file: String,
    line: String,
    column: String,
}

impl Check {
    /// Whether this is an assertion in a harness or in a property that it checks.
    fn is_claim(&self) -> bool {
        self.category == "assertion"
            && self.description.starts_with("assertion failed")
            && self.location.file.contains("proofs")
    }

    /// Whether it is of one place in the source: the compiler may copy a branch, and with it a
    /// check.
    fn is_copy_of(&self, other: &Self) -> bool {
        self.location == other.location && self.description == other.description
    }

    fn place(&self) -> String {
        let Location { file, line, .. } = &self.location;
        format!("{} ({file}:{line} in {})", self.description, self.function)
    }
}

/// What a run showed.
#[derive(Clone, Debug, PartialEq)]
pub struct Proven {
    pub checks: usize,
    /// Checks in library code that the harness's inputs never reach.
    pub unreachable: usize,
    pub covers: usize,
    pub seconds: f64,
}

/// Why a run is no proof.
#[derive(Clone, Debug, PartialEq)]
pub struct Refused {
    pub verdict: ProofVerdict,
    pub why: String,
}

impl Refused {
    pub fn new(verdict: ProofVerdict, why: impl Into<String>) -> Self {
        let why = why.into();
        Self { verdict, why }
    }

    fn failed(why: impl Into<String>) -> Self {
        Self::new(ProofVerdict::Failed, why)
    }
}

impl Export {
    pub fn parse(text: &str) -> Result<Self, Error> {
        serde_json::from_str(text).map_err(Error::Export)
    }

    pub fn kani(&self) -> &str {
        &self.tools.kani
    }

    /// The version in "6.6.0 (cbmc-6.6.0)".
    pub fn cbmc(&self) -> &str {
        let version = self.tools.cbmc.as_deref().unwrap_or("unknown");
        version.split(' ').next().unwrap_or(version)
    }

    /// The program of a harness after it was linked, which CBMC checks.
    pub fn program(&self, harness: &str) -> Option<String> {
        let of = |one: &&Metadata| one.pretty_name == harness;
        let symbols = self.harness_metadata.iter().find(of)?.goto_file.as_ref()?;
        Some(symbols.replace(".symtab.out", ".out"))
    }

    /// Accepts a harness's run as a proof with `covers` witnesses, or says why not.
    pub fn accept(&self, harness: &str, covers: u32) -> Result<Proven, Refused> {
        let results = self.verification_results.results.iter();
        let reports: Vec<_> = results
            .filter(|report| report.harness_id == harness)
            .collect();
        let [report] = reports[..] else {
            let why = format!("Kani checked {} harnesses of this name", reports.len());
            return Err(Refused::failed(why));
        };
        self.ended_by_itself(harness)?;
        report.accept(covers)
    }

    /// Whether CBMC gave its results.
    fn ended_by_itself(&self, harness: &str) -> Result<(), Refused> {
        let of = |one: &&Exit| one.harness_id == harness;
        let exit = self
            .error_details
            .iter()
            .find(of)
            .and_then(|one| one.exit_status.as_deref());
        match exit {
            None | Some("properties_failed") => Ok(()),
            Some("timeout") => Err(Refused::new(ProofVerdict::NotSolved, "CBMC timed out")),
            Some("out_of_memory") => {
                let why = "CBMC was killed, as where memory runs out";
                Err(Refused::new(ProofVerdict::Unfinished, why))
            }
            Some(other) => {
                let why = format!("CBMC gave no results: {other}");
                Err(Refused::new(ProofVerdict::Unfinished, why))
            }
        }
    }
}

impl Report {
    fn accept(&self, covers: u32) -> Result<Proven, Refused> {
        let is_cover = |check: &&Check| check.category == "cover";
        let (witnesses, checks): (Vec<_>, Vec<_>) = self.checks.iter().partition(is_cover);
        let reached = |check: &Check, status: &str| {
            let copies = self.checks.iter().filter(|other| other.is_copy_of(check));
            copies.into_iter().any(|copy| copy.status == status)
        };
        let mut unreachable = 0;
        for check in &checks {
            match check.status.as_str() {
                "Success" => {}
                "Unreachable" if !check.is_claim() || reached(check, "Success") => unreachable += 1,
                status => return Err(Refused::failed(format!("{status}: {}", check.place()))),
            }
        }
        if !checks.iter().any(|check| check.is_claim()) {
            return Err(Refused::failed("no assertion of the harness was checked"));
        }
        if self.status != "Success" {
            return Err(Refused::failed(format!("Kani's verdict: {}", self.status)));
        }
        let mut places: Vec<&Check> = Vec::new();
        for &witness in &witnesses {
            if !reached(witness, "Satisfied") {
                let why = format!("cover {}: {}", witness.status, witness.place());
                return Err(Refused::failed(why));
            }
            if !places.iter().any(|place| place.is_copy_of(witness)) {
                places.push(witness);
            }
        }
        if places.len() != covers as usize {
            let why = format!("{} covers, the ledger says {covers}", places.len());
            return Err(Refused::failed(why));
        }
        Ok(Proven {
            checks: checks.len(),
            unreachable,
            covers: places.len(),
            seconds: self.duration_ms as f64 / 1000.0,
        })
    }
}

/// Name and version of the SAT solver that ran for a harness, from what Kani prints: the export
/// names the one that was asked for.
pub fn solver(output: &str, harness: &str) -> Option<String> {
    let begin = format!("Checking harness {harness}...");
    let part = output.split_once(&begin)?.1;
    let part = part.split("Checking harness ").next()?;
    let mut lines = part
        .lines()
        .filter_map(|line| line.strip_prefix("Solving with "));
    lines.next().map(str::to_owned)
}

#[cfg(test)]
pub mod tests {
    use super::*;

    pub const HARNESS: &str = "proofs::energy::the_ledger_balances";

    /// Kani's export for a harness that was proven.
    pub const PROVEN: &str = r#"{
        "tools": {"kani": "0.68.0", "cbmc": "6.6.0 (cbmc-6.6.0)", "solvers": []},
        "harness_metadata": [{"pretty_name": "proofs::energy::the_ledger_balances",
            "goto_file": "/target/a__balances.symtab.out"}],
        "error_details": [{"harness_id": "proofs::energy::the_ledger_balances",
            "has_errors": false}],
        "verification_results": {"results": [{
            "harness_id": "proofs::energy::the_ledger_balances",
            "status": "Success", "duration_ms": 815,
            "checks": [
                {"id": 1, "function": "energy::spend", "status": "Success",
                 "description": "attempt to subtract with overflow", "category": "assertion",
                 "location": {"file": "core/src/energy.rs", "line": "40", "column": "5"}},
                {"id": 2, "function": "balances", "status": "Success",
                 "description": "assertion failed: after <= capacity", "category": "assertion",
                 "location": {"file": "core/src/proofs/energy.rs", "line": "20", "column": "5"}},
                {"id": 3, "function": "energy::spend", "status": "Unreachable",
                 "description": "attempt to divide by zero", "category": "assertion",
                 "location": {"file": "core/src/energy.rs", "line": "44", "column": "9"}},
                {"id": 4, "function": "balances", "status": "Satisfied",
                 "description": "the battery runs empty", "category": "cover",
                 "location": {"file": "core/src/proofs/energy.rs", "line": "22", "column": "5"}}
            ]}]}
    }"#;

    /// The same for a run of CBMC that ended without results.
    pub fn ended(exit_status: &str) -> String {
        let begin = PROVEN.find("\"checks\": [").unwrap();
        let end = PROVEN.rfind("]}]}").unwrap();
        let text = format!("{}\"checks\": [{}", &PROVEN[..begin], &PROVEN[end..]);
        let error = format!("\"has_errors\": true, \"exit_status\": \"{exit_status}\"");
        text.replace("\"has_errors\": false", &error)
            .replace("Success", "Failure")
    }

    fn accept(text: &str) -> Result<Proven, Refused> {
        Export::parse(text).unwrap().accept(HARNESS, 1)
    }

    fn why(text: &str) -> String {
        accept(text).unwrap_err().why
    }

    #[test]
    fn a_proof_is_accepted() {
        let proven = Proven {
            checks: 3,
            unreachable: 1,
            covers: 1,
            seconds: 0.815,
        };
        assert_eq!(accept(PROVEN), Ok(proven));
        let export = Export::parse(PROVEN).unwrap();
        assert_eq!((export.kani(), export.cbmc()), ("0.68.0", "6.6.0"));
        assert_eq!(export.program(HARNESS).unwrap(), "/target/a__balances.out");
    }

    /// Catches a harness that is misspelt in the ledger, for which Kani checks nothing.
    #[test]
    fn a_harness_that_was_not_checked_is_no_proof() {
        let export = Export::parse(PROVEN).unwrap();
        let refused = export
            .accept("proofs::energy::the_ledger_balance", 1)
            .unwrap_err();
        assert_eq!(refused.why, "Kani checked 0 harnesses of this name");
        let begin = PROVEN.find("[{\n            \"harness_id\"").unwrap();
        let end = PROVEN.rfind("}\n    }").unwrap();
        let none = format!("{}[]{}", &PROVEN[..begin], &PROVEN[end..]);
        assert_eq!(why(&none), "Kani checked 0 harnesses of this name");
    }

    #[test]
    fn a_run_without_results_is_no_proof() {
        for (exit, verdict) in [
            ("timeout", ProofVerdict::NotSolved),
            ("out_of_memory", ProofVerdict::Unfinished),
            ("exit_code_6", ProofVerdict::Unfinished),
        ] {
            assert_eq!(accept(&ended(exit)).unwrap_err().verdict, verdict, "{exit}");
        }
        // A run that ended well but has no check.
        let empty = ended("").replace("\"exit_status\": \"\"", "\"exit_status\": null");
        assert_eq!(why(&empty), "no assertion of the harness was checked");
    }

    /// Catches an export that was cut where the disk was full.
    #[test]
    fn half_an_export_is_an_error() {
        for length in [0, 1, PROVEN.len() / 2, PROVEN.len() - 2] {
            let error = Export::parse(&PROVEN[..length]).unwrap_err();
            assert!(error.to_string().contains("broken"), "{error}");
        }
    }

    /// Catches a success of Kani's that shows nothing.
    #[test]
    fn a_success_that_shows_nothing_is_no_proof() {
        let claim = PROVEN.replacen(
            "\"balances\", \"status\": \"Success\"",
            "\"balances\", \"status\": \"Unreachable\"",
            1,
        );
        assert!(why(&claim).starts_with("Unreachable: assertion failed"));
        let cover = PROVEN.replace("Satisfied", "Unsatisfiable");
        assert!(why(&cover).starts_with("cover Unsatisfiable: the battery"));
        let failed = PROVEN.replacen(
            "\"status\": \"Success\",\n                 \"desc",
            "\"status\": \"Failure\",\n                 \"desc",
            1,
        );
        assert!(
            why(&failed).starts_with("Failure: attempt to subtract"),
            "{}",
            why(&failed)
        );
        let unknown = PROVEN.replace("Unreachable", "Undetermined");
        assert!(why(&unknown).starts_with("Undetermined"));
        let verdict = PROVEN.replace(
            "\"status\": \"Success\", \"dur",
            "\"status\": \"Failure\", \"dur",
        );
        assert_eq!(why(&verdict), "Kani's verdict: Failure");
        let export = Export::parse(PROVEN).unwrap();
        assert_eq!(
            export.accept(HARNESS, 2).unwrap_err().why,
            "1 covers, the ledger says 2"
        );
    }

    /// Catches a cover that counts as lost because the compiler copied its branch.
    #[test]
    fn copies_of_a_check_count_as_one() {
        let cover = PROVEN.find("{\"id\": 4").unwrap();
        let end = PROVEN.rfind("]}]}").unwrap();
        let copy = PROVEN[cover..end].replace("Satisfied", "Unsatisfiable");
        let twice = format!("{}{copy}, {}", &PROVEN[..cover], &PROVEN[cover..]);
        assert_eq!(accept(&twice).unwrap().covers, 1);
        let elsewhere = twice.replacen("\"line\": \"22\"", "\"line\": \"23\"", 1);
        assert!(why(&elsewhere).starts_with("cover Unsatisfiable"));
    }

    #[test]
    fn the_solver_is_the_one_that_ran() {
        let output = "Checking harness a::b...\nSolving with MiniSAT 2.2.1\n\
                      Checking harness a::c...\nnothing\n";
        assert_eq!(solver(output, "a::b").as_deref(), Some("MiniSAT 2.2.1"));
        assert_eq!(solver(output, "a::c"), None);
        assert_eq!(solver(output, "a"), None);
    }
}
