//! Embeds the golden traces, so that the program needs no file system at run time.

use std::fmt::Write;
use std::path::PathBuf;
use std::{env, fs};

fn main() {
    let golden = PathBuf::from(env::var("CARGO_MANIFEST_DIR").expect("set by cargo"))
        .join("../golden")
        .canonicalize()
        .expect("tests/golden");
    println!("cargo::rerun-if-changed={}", golden.display());

    let mut traces: Vec<PathBuf> = fs::read_dir(&golden)
        .expect("tests/golden")
        .map(|entry| entry.expect("tests/golden").path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "jsonl")
        })
        .collect();
    traces.sort();
    assert!(
        !traces.is_empty(),
        "no golden trace in {}",
        golden.display()
    );

    let mut list = String::from("&[\n");
    for trace in &traces {
        let name = trace.file_stem().expect("a file").to_string_lossy();
        writeln!(
            list,
            "    ({name:?}, include_str!({:?})),",
            trace.display().to_string()
        )
        .expect("a string grows");
    }
    list.push_str("]\n");
    let out = PathBuf::from(env::var("OUT_DIR").expect("set by cargo"));
    fs::write(out.join("golden.rs"), list).expect("OUT_DIR is writable");
}
