//! The public items of the Rust libraries, against the lists that are checked in.
//!
//! `.ci/gates.sh` runs it in the repository's folder. Its `--bless` writes the lists anew.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use public_api::Builder;

/// The libraries that programs in Rust are written against.
const LIBRARIES: [&str; 6] = [
    "jcas-core",
    "jcas-policy",
    "jcas-simd",
    "jcas-trace",
    "jcas-plan",
    "jcas-episode",
];
const FOLDER: &str = "tests/api/lists";
/// Within Cargo's target folder; the format is one of rustdoc's unstable options.
const BUILT: &str = "api";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match arguments.as_slice() {
        [] => run(false),
        [option] if option == "--bless" => run(true),
        _ => Err("there is --bless".to_owned()),
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

/// Compares each list with the sources, or writes it anew.
fn run(bless: bool) -> Result<bool, String> {
    let documents = document()?;
    let mut same = true;
    for library in LIBRARIES {
        let found = items(&documents.join(format!("{}.json", library.replace('-', "_"))))?;
        let list = Path::new(FOLDER).join(format!("{library}.txt"));
        if bless {
            std::fs::create_dir_all(FOLDER).map_err(|error| format!("{FOLDER}: {error}"))?;
            std::fs::write(&list, found).map_err(|error| format!("{}: {error}", list.display()))?;
            continue;
        }
        let listed = std::fs::read_to_string(&list)
            .map_err(|error| format!("{}: {error}", list.display()))?;
        let changes = changes(&listed, &found);
        if !changes.is_empty() {
            same = false;
            println!("{}:\n{}", list.display(), changes.join("\n"));
        }
    }
    if !same {
        println!("If that is meant, `.ci/gates.sh --bless` writes the lists anew.");
    }
    Ok(same)
}

/// Lets rustdoc describe the libraries as JSON, and returns the folder of the files.
fn document() -> Result<PathBuf, String> {
    let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    let target = Path::new(&target).join(BUILT);
    let status = Command::new("cargo")
        .args(["doc", "--locked", "--quiet", "--no-deps", "--all-features"])
        .args(LIBRARIES.map(|library| format!("--package={library}")))
        .arg("--target-dir")
        .arg(&target)
        .env("RUSTC_BOOTSTRAP", "1")
        .env("RUSTDOCFLAGS", "-Z unstable-options --output-format json")
        .status()
        .map_err(|error| format!("cannot start cargo: {error}"))?;
    if status.success() {
        Ok(target.join("doc"))
    } else {
        Err("cargo doc failed".to_owned())
    }
}

/// The public items, one a line, without what the compiler implements for every type.
fn items(document: &Path) -> Result<String, String> {
    Builder::from_rustdoc_json(document)
        .omit_blanket_impls(true)
        .omit_auto_trait_impls(true)
        .build()
        .map(|api| api.to_string())
        .map_err(|error| format!("{}: {error}", document.display()))
}

/// The lines that only one of the texts has, or has more often: `-` where it is the first one.
fn changes(listed: &str, found: &str) -> Vec<String> {
    let mut surplus: HashMap<&str, i32> = HashMap::new();
    for line in found.lines() {
        *surplus.entry(line).or_default() += 1;
    }
    for line in listed.lines() {
        *surplus.entry(line).or_default() -= 1;
    }
    let mut changes: Vec<_> = surplus
        .into_iter()
        .filter(|(_, count)| *count != 0)
        .map(|(line, count)| (line, if count < 0 { '-' } else { '+' }))
        .collect();
    changes.sort_unstable();
    changes
        .into_iter()
        .map(|(line, sign)| format!("{sign}{line}"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_differ_are_named() {
        assert!(changes("a\nb\nb\n", "b\na\nb\n").is_empty());
        assert_eq!(
            changes("fn f(u8)\nfn g()\nfn g()\n", "fn f(u16)\nfn g()\n"),
            ["+fn f(u16)", "-fn f(u8)", "-fn g()"]
        );
    }
}
