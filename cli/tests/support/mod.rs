//! Helpers that run the command as a user would.

use std::path::Path;
use std::process::{Command, Output};

/// Runs `jcas` with the given arguments in a folder.
pub fn jcas(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(assert_cmd::cargo::cargo_bin!("jcas"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the command runs")
}

/// Runs `jcas`, checks that it succeeds, and returns its output.
pub fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = jcas(folder, arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {errors}");
    String::from_utf8(output.stdout).expect("the output is UTF-8")
}
