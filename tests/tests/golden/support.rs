//! Reading of golden traces.

use std::path::PathBuf;
use std::{env, fs};

use jcas_episode::trace::{self, Step, Trace};

pub fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden")
}

pub fn read(name: &str) -> Trace {
    let path = folder().join(format!("{name}.jsonl"));
    let bytes = fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    trace::read(bytes.as_slice()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Reads a trace and verifies that this build reproduces it. With `JCAS_BLESS=1` the file is
/// replaced first, by what this build makes of the same actions.
pub fn reproduced(name: &str) -> Trace {
    let mut trace = read(name);
    if env::var_os("JCAS_BLESS").is_some() {
        let text = trace::rerecord(&trace).unwrap_or_else(|error| panic!("{name}: {error}"));
        let path = folder().join(format!("{name}.jsonl"));
        fs::write(path.with_extension("new"), text).expect("the folder can be written");
        fs::rename(path.with_extension("new"), path).expect("the folder can be written");
        trace = read(name);
    }
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
