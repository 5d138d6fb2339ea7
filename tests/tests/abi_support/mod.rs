//! Builds C and C++ programs against the library of this workspace.
// Each test file uses its own part of this module.
#![allow(dead_code)]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the tests lie in the workspace")
}

/// The files of the golden traces, in order of their names.
pub fn golden_traces() -> Vec<PathBuf> {
    let folder = root().join("tests/golden");
    let mut traces: Vec<PathBuf> = fs::read_dir(folder)
        .expect("the golden traces are there")
        .map(|entry| entry.expect("a readable folder").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "jsonl"))
        .collect();
    traces.sort();
    assert!(traces.len() >= 21, "traces are missing: {traces:?}");
    traces
}

/// Runs a command that has to succeed.
pub fn run(command: &mut Command) -> Output {
    let output = command
        .output()
        .unwrap_or_else(|error| panic!("{command:?}: {error}"));
    assert!(
        output.status.success(),
        "{command:?}: {}\n{}{}",
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

/// Compilers of a language: the first one that is installed, or those that `JCAS_COMPILERS` names.
fn compilers(names: &[&'static str]) -> Vec<&'static str> {
    let here = |name: &&'static str| {
        let version = Command::new(name).arg("--version").output();
        version.is_ok_and(|output| output.status.success())
    };
    let Ok(wanted) = std::env::var("JCAS_COMPILERS") else {
        return names.iter().copied().find(here).into_iter().collect();
    };
    let is_wanted = |name: &&'static str| wanted.split(' ').any(|word| word == *name);
    let found: Vec<_> = names.iter().copied().filter(is_wanted).collect();
    assert!(
        !found.is_empty(),
        "JCAS_COMPILERS={wanted} has none of {names:?}"
    );
    assert!(found.iter().all(here), "not all of {found:?} are installed");
    found
}

/// Reports on standard error that a check did not run; the harness hides the output of a passed
/// test.
pub fn skip(why: &str) {
    let _ = writeln!(std::io::stderr(), "skipped: {why}");
}

/// C compilers, of which at least one has to be installed.
pub fn c_compilers() -> Vec<&'static str> {
    let found = compilers(&["gcc", "clang"]);
    assert!(!found.is_empty(), "neither gcc nor clang is installed");
    found
}

/// C++ compilers. A machine may have none; then the tests that need one report that they skip it.
pub fn cpp_compilers() -> Vec<&'static str> {
    let found = compilers(&["g++", "clang++"]);
    if found.is_empty() {
        skip("neither g++ nor clang++ is installed");
    }
    found
}

/// The libraries that Cargo built for this test, beside which they lie: static, shared.
pub fn libraries() -> (PathBuf, PathBuf) {
    let test = std::env::current_exe().expect("the test has a path");
    let library = |name| {
        let path = test.with_file_name(name);
        assert!(path.is_file(), "{} is not built", path.display());
        path
    };
    (library("libjcas.a"), library("libjcas.so"))
}

/// Compiles a program and links it with the static library.
pub fn compile(compiler: &str, standard: &str, name: &str, sources: &[PathBuf]) -> PathBuf {
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{compiler}"));
    let mut command = Command::new(compiler);
    command
        .arg(format!("-std={standard}"))
        .args(["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-g", "-O1"])
        .arg("-I")
        .arg(root().join("include"))
        .args(sources)
        .arg(&libraries().0)
        .args(["-lpthread", "-ldl", "-lm", "-o"])
        .arg(&program);
    run(&mut command);
    program
}

/// Names of the functions that a header declares.
pub fn declared_functions(header: &str) -> Vec<String> {
    let code: Vec<&str> = header
        .lines()
        .filter(|line| !line.trim_start().starts_with("//") && !line.starts_with(" *"))
        .collect();
    let mut names: Vec<String> = code
        .join("\n")
        .split('(')
        .filter_map(|before| {
            let name: String = before
                .chars()
                .rev()
                .take_while(|c| c.is_ascii_alphanumeric() || *c == '_')
                .collect();
            let name: String = name.chars().rev().collect();
            name.starts_with("jcas_").then_some(name)
        })
        .collect();
    names.sort();
    names.dedup();
    names
}
