//! `verification/proofs.toml`: what is claimed, and how each claim is checked.

use serde::Deserialize;
use std::path::{Path, PathBuf};

/// The whole ledger.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ledger {
    pub proof: Vec<Proof>,
}

/// One harness.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Proof {
    /// The property it belongs to: P1, P2, ...
    pub id: String,
    /// Cargo package that holds the harness.
    pub package: String,
    /// Full path of the harness within its crate.
    pub harness: String,
    /// What it shows, in one sentence.
    pub claim: String,
    /// For which inputs.
    pub bound: String,
    /// Rows of ASSUMPTIONS.md that it rests on.
    pub assumptions: Vec<String>,
    /// How many cover properties it has; all must be satisfied.
    pub covers: u32,
    /// What it, or the one it was split from, took Kani on two busy cores.
    #[serde(default)]
    measured_s: u64,
    /// What it may take, where nobody has measured it.
    #[serde(default)]
    estimated_s: u64,
    /// What Kani is told beside what it is told of every harness; `--cbmc-args` and what follows it last.
    #[serde(default)]
    pub flags: Vec<String>,
    /// The deliberate fault that must make it fail.
    pub mutant: Mutant,
}

/// One edit of a source file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mutant {
    /// Path from the workspace's root.
    pub file: String,
    /// Text that occurs exactly once there.
    pub find: String,
    /// What takes its place.
    pub replace: String,
}

impl Proof {
    /// The harness's own name, without its modules.
    pub fn name(&self) -> &str {
        self.harness.rsplit("::").next().unwrap_or(&self.harness)
    }

    /// Time after which it counts as failed: five times what it takes, as a machine may be half as fast and
    /// busy, and at least a minute.
    pub fn time_limit_s(&self) -> u64 {
        (5 * (self.measured_s + self.estimated_s)).max(60)
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
    pub fn read() -> Result<Self, String> {
        let path = workspace_root().join("verification/proofs.toml");
        let text = std::fs::read_to_string(&path)
            .map_err(|error| format!("{}: {error}", path.display()))?;
        toml::from_str(&text).map_err(|error| format!("{}: {error}", path.display()))
    }

    /// The proofs that `names` select by id or harness name; all of them without names.
    pub fn select(self, names: &[String]) -> Result<Vec<Proof>, String> {
        for name in names {
            if !self.proof.iter().any(|proof| matches(proof, name)) {
                return Err(format!(
                    "no proof is called `{name}` in verification/proofs.toml"
                ));
            }
        }
        let wanted =
            |proof: &Proof| names.is_empty() || names.iter().any(|name| matches(proof, name));
        Ok(self.proof.into_iter().filter(wanted).collect())
    }
}

fn matches(proof: &Proof, name: &str) -> bool {
    proof.id == name || proof.name() == name || proof.harness == name
}

/// The folder that holds the workspace's Cargo.toml.
pub fn workspace_root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}
