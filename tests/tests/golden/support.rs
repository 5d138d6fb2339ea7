//! Reading of golden traces.

use std::fs;
use std::path::PathBuf;

use jcas_episode::trace::{self, Step, Trace};

pub fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden")
}

pub fn read(name: &str) -> Trace {
    let path = folder().join(format!("{name}.jsonl"));
    let bytes = fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    trace::read(bytes.as_slice()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Reads a trace and verifies that this build reproduces it.
pub fn reproduced(name: &str) -> Trace {
    let trace = read(name);
    match trace::verify(&trace) {
        Ok(None) => trace,
        Ok(Some(difference)) => panic!("{name}: {difference}"),
        Err(error) => panic!("{name}: {error}"),
    }
}

/// Pairs of consecutive steps.
pub fn pairs(trace: &Trace) -> impl Iterator<Item = (&Step, &Step)> {
    trace.steps.windows(2).map(|pair| (&pair[0], &pair[1]))
}
