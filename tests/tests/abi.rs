//! C and C++ programs against the library: their results, and the refusal of every wrong call.
//!
//! These tests catch an ABI whose results differ from the kernel's, and a function that writes
//! before its checks. They also catch an invalid handle that is accepted, and an example that no
//! longer compiles.

mod abi_support;

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use abi_support::{c_compilers, compile, cpp_compilers, golden_traces, root, run};

fn c_tests(names: &[&str]) -> Vec<PathBuf> {
    names
        .iter()
        .map(|name| root().join("tests/c").join(name))
        .collect()
}

#[test]
fn golden_traces_have_the_same_hashes_through_the_abi() {
    let traces = golden_traces();
    for compiler in c_compilers() {
        let replay = compile(compiler, "c11", "replay", &c_tests(&["replay.c"]));
        let output = run(Command::new(&replay).args(&traces)).stdout;
        let lines = String::from_utf8(output).expect("text").lines().count();
        assert_eq!(lines, traces.len());
    }
}

#[test]
fn a_changed_trace_is_noticed() {
    let trace = root().join("tests/golden/one_uav.jsonl");
    let text = fs::read_to_string(trace).expect("the golden trace is there");
    let at = text.rfind("\"state_hash\":\"0x").expect("a hash") + 16;
    let digit = if &text[at..=at] == "0" { "1" } else { "0" };
    let changed = format!("{}{digit}{}", &text[..at], &text[at + 1..]);
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("changed.jsonl");
    fs::write(&path, changed).expect("the target folder can be written");
    let compiler = c_compilers()[0];
    let replay = compile(compiler, "c11", "replay-changed", &c_tests(&["replay.c"]));
    let output = Command::new(replay).arg(path).output().expect("it runs");
    assert!(!output.status.success());
    assert!(String::from_utf8_lossy(&output.stderr).contains("state_hash"));
}

#[test]
fn every_wrong_call_is_refused() {
    let sources = c_tests(&[
        "abuse.c",
        "abuse_config.c",
        "abuse_sim.c",
        "abuse_read.c",
        "abuse_batch.c",
    ]);
    for compiler in c_compilers() {
        run(&mut Command::new(compile(
            compiler, "c11", "abuse", &sources,
        )));
    }
}

#[test]
fn threads_compute_what_one_computes() {
    let compiler = c_compilers()[0];
    run(&mut Command::new(compile(
        compiler,
        "c11",
        "threads",
        &c_tests(&["threads.c"]),
    )));
}

#[test]
fn the_end_of_memory_is_a_status() {
    let compiler = c_compilers()[0];
    let program = compile(compiler, "gnu11", "scarce", &c_tests(&["scarce.c"]));
    let policy = root().join("policies/mission/policy.safetensors");
    run(Command::new(program).arg(policy));
}

#[test]
fn tasks_snapshots_and_forks_of_batches() {
    for compiler in c_compilers() {
        let source = c_tests(&["tasks.c"]);
        run(&mut Command::new(compile(
            compiler, "c11", "tasks", &source,
        )));
    }
}

#[test]
fn nothing_is_allocated_in_the_callers_memory() {
    for compiler in c_compilers() {
        let source = c_tests(&["no_allocation.c"]);
        run(&mut Command::new(compile(
            compiler,
            "c11",
            "no_allocation",
            &source,
        )));
    }
}

#[test]
fn owners_own_with_and_without_exceptions() {
    let source = c_tests(&["owners.cpp"]);
    for compiler in cpp_compilers() {
        run(&mut Command::new(compile(
            compiler, "c++17", "owners", &source,
        )));
        let mixed = c_tests(&["owners_mixed.cpp", "owners_plain.cpp"]);
        run(&mut Command::new(compile(
            compiler, "c++17", "mixed", &mixed,
        )));
        let throwing = root().join("tests/c/owners_throwing.cpp");
        run(&mut Command::new(compile(
            compiler,
            "c++17",
            "throwing",
            &[throwing],
        )));
    }
}

/// At least one abuse test names each exported function, so that none is forgotten.
#[test]
fn abuse_leaves_no_function_out() {
    let header = fs::read_to_string(root().join("include/jcas.h")).expect("the header is there");
    let mut abuse = String::new();
    for file in c_tests(&[
        "abuse.c",
        "abuse_config.c",
        "abuse_sim.c",
        "abuse_read.c",
        "abuse_batch.c",
        "plans.c",
        "policies.c",
        "futures.c",
        "traces.c",
    ]) {
        abuse += &fs::read_to_string(file).expect("the tests are there");
    }
    let functions = abi_support::declared_functions(&header);
    assert!(functions.len() > 40);
    for function in functions {
        assert!(abuse.contains(&function), "{function} is abused nowhere");
    }
}

#[test]
fn examples_compile_and_fly() {
    for compiler in c_compilers() {
        for (name, says) in [
            ("minimal", "5 of 5 hotspots confirmed"),
            ("batch", "313 episodes ended"),
            ("external_mobility", "3 known to all"),
        ] {
            let source = root().join(format!("examples/c/{name}.c"));
            let program = compile(compiler, "c11", name, &[source]);
            let output = String::from_utf8(run(&mut Command::new(program)).stdout).expect("text");
            assert!(output.contains(says), "{name}: {output}");
        }
    }
    for compiler in cpp_compilers() {
        let source = root().join("examples/cpp/fleet.cpp");
        let program = compile(compiler, "c++17", "fleet", &[source]);
        let output = String::from_utf8(run(&mut Command::new(program)).stdout).expect("text");
        assert!(output.contains("complete in"), "fleet: {output}");
    }
    let lines = fs::read_to_string(root().join("examples/c/minimal.c"))
        .expect("the example is there")
        .lines()
        .count();
    assert!(lines < 60, "the minimal example has {lines} lines");
}
