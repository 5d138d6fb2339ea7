//! `verification/results.toml`: what the model checker said of each harness, and when.

use crate::{Ledger, LedgerError, Proof, Sources, read, workspace_root, write};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// All recorded results.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Results {
    /// The runs that gave the outcomes below.
    #[serde(default)]
    pub run: Vec<Run>,
    /// The newest outcome of each harness.
    #[serde(default)]
    pub outcome: Vec<Outcome>,
}

/// One run of the model checker over some or all harnesses.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Abbreviated hash of the commit; its sources had no further changes.
    pub commit: String,
    /// Day in UTC, as 2026-11-24.
    pub date: String,
    /// Version of Kani.
    pub kani: String,
    /// Version of CBMC.
    pub cbmc: String,
    /// Processors and load.
    pub machine: String,
}

/// The outcome of one run for one harness.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Outcome {
    /// Cargo package that holds the harness.
    pub package: String,
    /// Full path of the harness within its crate.
    pub harness: String,
    /// The commit of its run.
    pub commit: String,
    /// What the run showed.
    pub verdict: ProofVerdict,
    /// Checks other than covers, where they were counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checks: Option<u32>,
    /// Cover properties that were reached, where they were counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub covers: Option<u32>,
    /// Seconds by the clock, without the compilation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// Name and version of the SAT solver that ran.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver: Option<String>,
    /// What Kani said of the harness's mutant, where it was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mutant: Option<String>,
    /// Why it failed, or how it was run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// The workspace's files that the checked program has a line of.
    pub files: Vec<String>,
    /// Fingerprint of these files and of what they import; empty where there was no program.
    pub sources: String,
}

/// The verdict of a run about a claim.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ProofVerdict {
    /// Every check holds and every cover is reached.
    Verified,
    /// A check fails, or a cover is not reached.
    Failed,
    /// No answer within the time limit.
    NotSolved,
    /// The run was ended before its time limit, so it shows nothing.
    Unfinished,
}

impl Results {
    /// Where the results of this workspace lie.
    pub fn path() -> PathBuf {
        workspace_root().join("verification/results.toml")
    }

    /// Reads the results of this workspace.
    pub fn read() -> Result<Self, LedgerError> {
        let path = Self::path();
        toml::from_str(&read(&path)?).map_err(LedgerError::toml(path))
    }

    /// Writes the results of this workspace.
    pub fn write(&self) -> Result<(), LedgerError> {
        write(&Self::path(), &self.to_text()?)
    }

    /// The text of `results.toml`.
    pub fn to_text(&self) -> Result<String, LedgerError> {
        let rows = toml::to_string(self)?;
        Ok(format!(
            "# What Kani said of each harness, written by `cargo xtask prove`; RESULTS.md is the \
             page.\n\n{rows}"
        ))
    }

    /// Puts a run and its outcomes in the place of older outcomes of the same harnesses.
    pub fn record(&mut self, run: Run, outcomes: Vec<Outcome>) {
        for outcome in outcomes {
            self.outcome
                .retain(|old| !(old.package == outcome.package && old.harness == outcome.harness));
            self.outcome.push(outcome);
        }
        self.run.retain(|old| old.commit != run.commit);
        self.run.push(run);
    }

    /// Drops outcomes of harnesses that the ledger no longer lists, and runs without an outcome.
    /// The others stand in the order of the ledger.
    pub fn prune(&mut self, ledger: &Ledger) {
        let mut kept = Vec::new();
        for proof in &ledger.proof {
            kept.extend(self.of(proof).cloned());
        }
        self.outcome = kept;
        let outcomes = &self.outcome;
        self.run
            .retain(|run| outcomes.iter().any(|outcome| outcome.commit == run.commit));
    }

    /// The outcome of a harness; none if it has not been run yet.
    pub fn of(&self, proof: &Proof) -> Option<&Outcome> {
        self.outcome
            .iter()
            .find(|outcome| outcome.package == proof.package && outcome.harness == proof.harness)
    }

    /// Keeps what Kani said of a mutant beside the verdict of its harness on these sources.
    pub fn tell_mutant(&mut self, proof: &Proof, now: &Sources, said: &str) {
        let of = |row: &&mut Outcome| row.package == proof.package && row.harness == proof.harness;
        let row = self.outcome.iter_mut().find(of);
        if let Some(row) = row.filter(|row| row.is_of(now)) {
            row.mutant = Some(said.to_owned());
        }
    }

    /// Whether a harness is verified on these sources.
    pub fn is_current(&self, proof: &Proof, now: &Sources) -> bool {
        self.of(proof)
            .is_some_and(|outcome| outcome.verdict == ProofVerdict::Verified && outcome.is_of(now))
    }
}

impl Outcome {
    /// Whether it is of these sources.
    pub fn is_of(&self, now: &Sources) -> bool {
        now.fingerprint(&self.files).as_ref() == Some(&self.sources)
    }
}
