//! Running the command as a person would.

use std::path::Path;
use std::process::{Command, Output};

/// Runs `jcas-lab` with the given arguments in a folder.
pub fn lab(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(assert_cmd::cargo::cargo_bin!("jcas-lab"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the command runs")
}

/// Runs `jcas-lab`, which has to succeed, and returns what it printed.
pub fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = lab(folder, arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {errors}");
    String::from_utf8(output.stdout).expect("the output is UTF-8")
}
