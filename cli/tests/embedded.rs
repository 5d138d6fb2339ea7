//! A C program and the command run a policy with the same results, bit for bit.

mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use support::succeed;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the command lies in the workspace")
}

fn printed(command: &mut Command) -> String {
    let output = command
        .output()
        .unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {error}");
    String::from_utf8(output.stdout).expect("text")
}

/// Compiles `examples/c/fly_policy.c` against the library.
fn example(folder: &Path) -> PathBuf {
    let test = std::env::current_exe().expect("the test has a path");
    // Cargo builds it for this test, beside which it lies.
    let library = test.with_file_name("libjcas.a");
    let program = folder.join("fly_policy");
    printed(
        Command::new("cc")
            .arg("-I")
            .arg(root().join("include"))
            .arg(root().join("examples/c/fly_policy.c"))
            .arg(library)
            .args(["-lpthread", "-ldl", "-lm", "-o"])
            .arg(&program),
    );
    program
}

#[test]
fn a_c_program_flies_the_shipped_fleet_as_the_command_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = example(folder.path());
    let trained = root().join("policies/mission");
    let file = trained.join("policy.safetensors");
    for (named, given) in [
        (trained.to_str(), file.to_str()),
        (Some("greedy"), Some("greedy")),
    ] {
        let (named, given) = (named.expect("a path"), given.expect("a path"));
        succeed(
            folder.path(),
            &[
                "simulate",
                "--policy",
                named,
                "--preset",
                "mission",
                "--uavs",
                "15",
                "--hotspots",
                "7",
                "--seed",
                "1",
                "--episodes",
                "1",
                "--trace",
                "flight.jsonl",
            ],
        );
        let trace = fs::read_to_string(folder.path().join("flight.jsonl")).expect("a trace");
        let (_, last) = trace
            .rsplit_once("\"state_hash\":\"")
            .expect("steps have a hash");
        let hash = &last[..18];
        let text = printed(Command::new(&program).arg(given));
        assert!(
            text.contains(&format!("state {hash}")),
            "{named}: {text}, not {hash}"
        );
    }
}
