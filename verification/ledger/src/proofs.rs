//! `verification/proofs.toml`: what is claimed, and how each claim is checked.

use crate::{LedgerError, read, workspace_root};
use serde::Deserialize;
use std::fmt;

/// The whole ledger.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ledger {
    /// Files and folders that harnesses may depend on, from the workspace's root.
    pub sources: Vec<String>,
    /// One row for each harness.
    pub proof: Vec<Proof>,
}

/// One harness.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Proof {
    /// The property it belongs to: P1, P2, …
    pub id: String,
    /// Cargo package that holds the harness.
    pub package: String,
    /// Full path of the harness within its crate.
    pub harness: String,
    /// The claim, in one sentence.
    pub claim: String,
    /// The inputs for which it holds.
    pub bound: String,
    /// Rows of ASSUMPTIONS.md that it rests on.
    pub assumptions: Vec<String>,
    /// Number of its cover properties; all must be satisfied.
    pub covers: u32,
    /// SAT solver that Kani is asked to use.
    #[serde(default)]
    pub solver: Solver,
    /// Further arguments of Kani; `--cbmc-args` and what follows it stand last.
    #[serde(default)]
    pub flags: Vec<String>,
    /// The deliberate fault that must make it fail.
    pub mutant: Mutant,
}

/// A SAT solver that CBMC can call.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Solver {
    /// Kani's own choice.
    #[default]
    Cadical,
    /// CBMC's own choice, faster for the calls of a host and for refusals.
    Minisat,
    /// An external program.
    Kissat,
}

impl fmt::Display for Solver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Cadical => "cadical",
            Self::Minisat => "minisat",
            Self::Kissat => "kissat",
        })
    }
}

/// One edit of a source file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mutant {
    /// Path from the workspace's root.
    pub file: String,
    /// Text that occurs exactly once there.
    pub find: String,
    /// The text that replaces it.
    pub replace: String,
}

impl Proof {
    /// The harness's own name, without its modules.
    pub fn name(&self) -> &str {
        self.harness.rsplit("::").next().unwrap_or(&self.harness)
    }

    /// The test that runs the harness body without Kani.
    pub fn twin(&self) -> String {
        match self.harness.rsplit_once("::") {
            Some((module, name)) => format!("{module}::twins::{name}"),
            None => format!("twins::{}", self.harness),
        }
    }
}

impl Ledger {
    /// Reads the ledger of this workspace.
    pub fn read() -> Result<Self, LedgerError> {
        let path = workspace_root().join("verification/proofs.toml");
        toml::from_str(&read(&path)?).map_err(LedgerError::toml(path))
    }

    /// The proofs that `names` select by id or harness name; all of them without names.
    pub fn select(&self, names: &[String]) -> Result<Vec<Proof>, LedgerError> {
        for name in names {
            if !self.proof.iter().any(|proof| matches(proof, name)) {
                return Err(LedgerError::UnknownProof(name.clone()));
            }
        }
        let wanted =
            |proof: &&Proof| names.is_empty() || names.iter().any(|name| matches(proof, name));
        Ok(self.proof.iter().filter(wanted).cloned().collect())
    }
}

fn matches(proof: &Proof, name: &str) -> bool {
    proof.id == name || proof.name() == name || proof.harness == name
}
