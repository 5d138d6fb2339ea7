//! What merging must know of a shard of a reproduction. It stands beside the shard's tables.

use std::path::Path;

use jcas_cli::error::CliError;
use jcas_cli::shard::{Build, Head, Manifest, require_equal};
use jcas_episode::shard::Shard;
use jcas_reproduce::shard::{Outline, RowCounts};
use serde::{Deserialize, Serialize};

/// The manifest.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReproductionManifest {
    format: u32,
    build: Build,
    /// Hash of everything that the results follow from.
    reproduction: String,
    shard: Shard,
    /// Number of units of all shards.
    pub units_in_all: u64,
    /// What the tables hold at the end; absent before.
    pub rows: Option<RowCounts>,
}

impl ReproductionManifest {
    /// The manifest of a shard that begins.
    pub fn new(shard: Shard, outline: &Outline) -> Result<Self, CliError> {
        Ok(Self {
            format: Self::FORMAT,
            build: Build::current()?,
            reproduction: format!("0x{:016x}", outline.fingerprint),
            shard,
            units_in_all: outline.units,
            rows: None,
        })
    }
}

impl Manifest for ReproductionManifest {
    const DESCRIBES: &'static str = "a reproduction's shard";
    const FORMAT: u32 = 1;

    fn head(&self) -> Head<'_> {
        Head {
            format: self.format,
            build: &self.build,
            shard: self.shard,
        }
    }

    fn require_same_work(&self, path: &Path, origin: &str, other: &Self) -> Result<(), CliError> {
        let hashes = (&self.reproduction, &other.reproduction);
        require_equal(path, origin, "other reproduction: fingerprint", hashes)?;
        let units = (&self.units_in_all, &other.units_in_all);
        require_equal(path, origin, "other reproduction: number of units", units)
    }
}
