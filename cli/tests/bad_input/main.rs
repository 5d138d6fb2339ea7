//! Every wrong input gives a message that names it, its value and the allowed ones, and an exit
//! code for its kind.

mod arguments;
mod configuration;
mod files;
#[path = "../support/mod.rs"]
mod support;
mod sweeps;

use std::path::Path;

use support::jcas;

const INPUT: i32 = 2;
const IO: i32 = 3;

/// Runs `jcas` and checks that it fails with a code and a message that holds every part.
fn refuses(folder: &Path, arguments: &[&str], code: i32, parts: &[&str]) {
    let output = jcas(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?} printed a result");
    for part in parts {
        assert!(
            message.contains(part),
            "{arguments:?}: no {part:?} in {message}"
        );
    }
}
