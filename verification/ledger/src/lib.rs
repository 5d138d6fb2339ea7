//! The ledger of the proofs: what each harness claims (`proofs.toml`), what the model checker said
//! of it (`results.toml`), and whether its sources have changed since.
//!
//! `cargo xtask prove` writes results with it; `verification/tests/ledger.rs` compares them with
//! the sources.

mod error;
mod page;
mod proofs;
mod results;
mod sources;

pub use error::LedgerError;
pub use page::{page, replace_summary, summary};
pub use proofs::{Ledger, Mutant, Proof, Solver};
pub use results::{Outcome, ProofVerdict, Results, Run};
pub use sources::Sources;

use std::path::{Path, PathBuf};

/// The folder that holds the workspace's Cargo.toml.
pub fn workspace_root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).unwrap_or(here).to_owned()
}

/// Reads a text file; the error names its path.
pub fn read(path: &Path) -> Result<String, LedgerError> {
    std::fs::read_to_string(path).map_err(LedgerError::file(path))
}

/// Writes a file to a temporary name and renames it, so that it is whole or not there.
pub fn write(path: &Path, text: &str) -> Result<(), LedgerError> {
    let explain = LedgerError::file(path);
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(&explain)?;
    }
    let partial = path.with_extension("partial");
    std::fs::write(&partial, text).map_err(&explain)?;
    std::fs::rename(&partial, path).map_err(explain)
}
