//! `jcas merge`: joins the parts of a sweep or of an evaluation.

use std::path::PathBuf;

use clap::Args;

use crate::error::{CliError, Outcome};
use crate::evaluation::{self, is_part};
use crate::files;
use crate::shard::{self, Manifest};
use crate::sweep::shard::{SweepManifest, table_of};
use crate::sweep::store::{Frame, Store};

const EXAMPLES: &str = "\
Examples:
  jcas sweep --out out --shard 1/2
  jcas sweep --out out --shard 2/2
  jcas merge out/results.csv out/shard-*-of-2.json
  jcas sweep --out out                     finds all cells on file and draws the figures
  jcas merge report.json parts/shard-*-of-8.json    after jcas evaluate --shard 1/8 to 8/8";

/// Join the parts that `--shard` of `jcas sweep` or `jcas evaluate` wrote
///
/// The table of a sweep and the report of an evaluation, as JSON, have the bytes of a single run.
/// Parts that are missing, given twice or incomplete are refused, and so are parts of another
/// sweep or evaluation, or by another build.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Merge {
    /// Table or report to write
    out: PathBuf,
    /// Manifests of all parts, shard-i-of-n.json; the tables of a sweep stand beside them
    #[arg(required = true, value_name = "SHARD")]
    shards: Vec<PathBuf>,
    /// Replace an output with another content
    #[arg(long)]
    overwrite: bool,
}

impl Merge {
    /// Checks the parts and writes the table or the report.
    pub fn run(self) -> Result<Outcome, CliError> {
        let (bytes, count, what) = if self.shards.first().is_some_and(|first| is_part(first)) {
            let (bytes, count) = evaluation::merged(shard::read_all(&self.shards, &self.out)?)?;
            (bytes, count, "episodes")
        } else {
            let merged = self.join(shard::read_all(&self.shards, &self.out)?)?;
            (merged.bytes()?, merged.len(), "cells")
        };
        shard::require_replaceable(&self.out, &bytes, self.overwrite)?;
        files::write_bytes(&self.out, &bytes)?;
        files::print(&format!(
            "{}: {count} {what} of {} shards\n",
            self.out.display(),
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
