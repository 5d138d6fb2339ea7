//! Writes the seed, the actions and the expected hashes of a golden trace as Rust constants.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

const TRACE: &str = "../golden/fifteen_uavs.jsonl";

fn main() {
    let out = env::var_os("OUT_DIR").expect("Cargo sets OUT_DIR");
    let out = Path::new(&out);
    let text = fs::read_to_string(TRACE).expect("the golden trace is in the repository");
    let mut lines = text.lines();
    let header = lines.next().expect("a trace has a header");
    let mut written = format!(
        "const SEED: u64 = {};\nconst CONFIG_HASH: u64 = {};\nconst INITIAL: Hashes = {};\n\
         const STEPS: &[Step] = &[\n",
        quoted(header, "seed"),
        quoted(header, "config_hash"),
        hashes(header)
    );
    for line in lines.filter(|line| line.starts_with("{\"kind\":\"step\"")) {
        let actions = between(line, "\"actions\":[[", "]]").replace("],[", ",");
        writeln!(
            written,
            "    Step {{ actions: [{actions}], hashes: {} }},",
            hashes(line)
        )
        .expect("a String takes every text");
    }
    written += "];\n";
    fs::write(out.join("golden.rs"), written).expect("OUT_DIR is writable");

    // The linker script of cortex-m-rt includes memory.x.
    fs::copy("memory.x", out.join("memory.x")).expect("OUT_DIR is writable");
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rerun-if-changed={TRACE}");
}

/// The fingerprints of a line as an expression of Rust.
fn hashes(line: &str) -> String {
    format!(
        "Hashes {{ observations: {}, state: {} }}",
        quoted(line, "observation_hash"),
        quoted(line, "state_hash")
    )
}

/// The text value of a key.
fn quoted<'t>(line: &'t str, key: &str) -> &'t str {
    between(line, &format!("\"{key}\":\""), "\"")
}

fn between<'t>(line: &'t str, begin: &str, end: &str) -> &'t str {
    let (_, rest) = line.split_once(begin).expect("the line has the key");
    rest.split_once(end).expect("the value ends").0
}
