//! `jcas merge`: joins the parts of a sweep.

use std::path::PathBuf;

use clap::Args;

use crate::error::{CliError, Outcome};
use crate::files;
use crate::sweep::shard::{Manifest, table_of};
use crate::sweep::store::{Frame, Store};

const EXAMPLES: &str = "\
Examples:
  jcas sweep --out out --shard 1/2
  jcas sweep --out out --shard 2/2
  jcas merge out/results.csv out/shard-*-of-2.json
  jcas sweep --out out                     finds all cells on file and draws the figures";

/// Number of missing parts that a message names.
const MISSING_SHOWN: usize = 20;

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
        let parts = self.parts()?;
        let merged = self.join(parts)?;
        let bytes = merged.bytes()?;
        if self.out.exists() && !self.overwrite {
            let earlier = std::fs::read(&self.out).map_err(CliError::io(&self.out))?;
            if earlier != bytes {
                let what = "holds another table; give another path, or --overwrite to replace it";
                return Err(CliError::file(&self.out, what));
            }
        }
        files::write_bytes(&self.out, &bytes)?;
        files::print(&format!(
            "{}: {} cells of {} shards\n",
            self.out.display(),
            merged.len(),
            self.shards.len()
        ))?;
        Ok(Outcome::Done)
    }

    /// The manifests in the order of their numbers, every number once.
    fn parts(&self) -> Result<Vec<(&PathBuf, Manifest)>, CliError> {
        let mut parts: Vec<(&PathBuf, Manifest)> = Vec::new();
        for path in &self.shards {
            let part = Manifest::read(path)?;
            if let Some((first_path, first)) = parts.first() {
                part.require_same(path, &first_path.display().to_string(), first)?;
            }
            parts.push((path, part));
        }
        parts.sort_by_key(|(_, part)| part.shard.number);
        for pair in parts.windows(2) {
            let [(path, part), (other_path, other)] = pair else {
                continue;
            };
            if part.shard == other.shard {
                return Err(CliError::input(format!(
                    "{} and {}: both are shard {}; give each shard once",
                    path.display(),
                    other_path.display(),
                    part.shard
                )));
            }
        }
        self.require_all(&parts)?;
        Ok(parts)
    }

    fn require_all(&self, parts: &[(&PathBuf, Manifest)]) -> Result<(), CliError> {
        let count = parts[0].1.shard.count;
        let given = |number: &usize| parts.iter().any(|(_, part)| part.shard.number == *number);
        let missing: Vec<String> = (1..=count)
            .filter(|number| !given(number))
            .take(MISSING_SHOWN)
            .map(|number| format!("shard-{number}-of-{count}.json"))
            .collect();
        if missing.is_empty() {
            return Ok(());
        }
        let names: Vec<String> = parts
            .iter()
            .map(|(path, _)| path.display().to_string())
            .collect();
        Err(CliError::input(format!(
            "{}: missing {}; all {count} shards are needed, given {}",
            self.out.display(),
            missing.join(", "),
            names.join(", ")
        )))
    }

    /// The table with the rows of all parts.
    fn join(&self, parts: Vec<(&PathBuf, Manifest)>) -> Result<Store, CliError> {
        let all = parts[0].1.cells_in_all;
        let mut frame = Frame {
            columns: parts[0].1.frame.columns.clone(),
            keys: vec![Vec::new(); all],
        };
        for (_, part) in &parts {
            for (cell, key) in part.shard.cells(all).zip(&part.frame.keys) {
                frame.keys[cell].clone_from(key);
            }
        }
        let mut merged = Store::empty(&self.out, frame);
        for (path, part) in parts {
            let cells = part.shard.cells(all);
            merged.take(Store::complete(&table_of(path), part.frame)?, cells);
        }
        Ok(merged)
    }
}
