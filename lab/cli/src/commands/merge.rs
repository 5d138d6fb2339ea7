//! `jcas-lab merge`: joins the shards of a reproduction.

use std::path::{Path, PathBuf};

use clap::Args;
use jcas_cli::error::{CliError, Outcome};
use jcas_cli::files;
use jcas_cli::shard::{self, Manifest};
use jcas_reproduce::shard::merge;

use super::failed;
use crate::manifest::ReproductionManifest;

const EXAMPLES: &str = "\
Examples:
  jcas-lab reproduce --out paper --shard 1/2
  jcas-lab reproduce --out paper --shard 2/2
  jcas-lab merge paper paper/shard-*-of-2.json
  jcas-lab reproduce --out paper           finds all results on file, draws figures and pages";

/// Join the shards of `jcas-lab reproduce --shard` into the tables of the whole reproduction
///
/// The tables results.csv and comparison.csv have the bytes that a single run writes. Shards that
/// are missing, given twice or not finished are refused, and so are shards of another reproduction
/// or by another build.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Merge {
    /// Folder for the tables
    out: PathBuf,
    /// Manifests of all shards, shard-i-of-n.json; the tables stand beside them
    #[arg(required = true, value_name = "SHARD")]
    shards: Vec<PathBuf>,
    /// Replace tables with another content
    #[arg(long)]
    overwrite: bool,
}

impl Merge {
    /// Checks the shards and writes the tables.
    pub fn run(self) -> Result<Outcome, CliError> {
        let (mut parts, mut units) = (Vec::new(), 0);
        for (path, manifest) in shard::read_all::<ReproductionManifest>(&self.shards, &self.out)? {
            let rows = manifest.rows.ok_or_else(|| {
                CliError::file(
                    path,
                    "is not finished; the shard's command goes on from there",
                )
            })?;
            let folder = path.parent().unwrap_or(Path::new(""));
            parts.push((manifest.shard(), folder, rows));
            units = manifest.units_in_all;
        }
        let mut written = Vec::new();
        for (name, bytes) in merge(&parts, units).map_err(failed)? {
            written.push((self.out.join(name), bytes));
        }
        for (path, bytes) in &written {
            shard::require_replaceable(path, bytes, self.overwrite)?;
        }
        files::prepare_folder(&self.out)?;
        for (path, bytes) in &written {
            files::write_bytes(path, bytes)?;
            let shards = parts.len();
            files::print(&format!("{}: joined of {shards} shards\n", path.display()))?;
        }
        Ok(Outcome::Done)
    }
}
