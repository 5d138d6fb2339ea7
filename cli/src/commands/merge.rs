//! `jcas merge`: joins the parts of a sweep.

use std::path::PathBuf;

use clap::Args;

use crate::error::{CliError, Outcome};
use crate::files;
use crate::shard::{self, Manifest};
use crate::sweep::shard::{SweepManifest, table_of};
use crate::sweep::store::{Frame, Store};

const EXAMPLES: &str = "\
Examples:
  jcas sweep --out out --shard 1/2
  jcas sweep --out out --shard 2/2
  jcas merge out/results.csv out/shard-*-of-2.json
  jcas sweep --out out                     finds all cells on file and draws the figures";

/// Join the parts that `jcas sweep --shard` wrote into the table of the whole sweep
///
/// The table has the bytes that the sweep writes in a single run. Parts that are missing, given
/// twice or incomplete are refused, and so are parts of another sweep or by another build.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Merge {
    /// Table to write
    out: PathBuf,
    /// Manifests of all parts, shard-i-of-n.json; the tables stand beside them
    #[arg(required = true, value_name = "SHARD")]
    shards: Vec<PathBuf>,
    /// Replace a table with another content
    #[arg(long)]
    overwrite: bool,
}

impl Merge {
    /// Checks the parts and writes the table.
    pub fn run(self) -> Result<Outcome, CliError> {
        let merged = self.join(shard::read_all(&self.shards, &self.out)?)?;
        let bytes = merged.bytes()?;
        shard::require_replaceable(&self.out, &bytes, self.overwrite)?;
        files::write_bytes(&self.out, &bytes)?;
        files::print(&format!(
            "{}: {} cells of {} shards\n",
            self.out.display(),
            merged.len(),
            self.shards.len()
        ))?;
        Ok(Outcome::Done)
    }

    /// The table with the rows of all parts.
    fn join(&self, parts: Vec<(&PathBuf, SweepManifest)>) -> Result<Store, CliError> {
        let all = parts[0].1.cells_in_all;
        let mut frame = Frame {
            columns: parts[0].1.frame.columns.clone(),
            keys: vec![Vec::new(); all],
        };
        for (_, part) in &parts {
            for (cell, key) in part.shard().cells(all).zip(&part.frame.keys) {
                frame.keys[cell].clone_from(key);
            }
        }
        let mut merged = Store::empty(&self.out, frame);
        for (path, part) in parts {
            let cells = part.shard().cells(all);
            merged.take(Store::complete(&table_of(path), part.frame)?, cells);
        }
        Ok(merged)
    }
}
