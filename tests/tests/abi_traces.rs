//! C programs record the same traces as the command, byte for byte, with the host's calls.
//!
//! These tests catch a field that the C interface and `jcas trace record` write differently, and a
//! host's call that is missing from the file. They also catch a file that one side writes and the
//! other does not read.

mod abi_support;

use std::fs;
use std::path::Path;
use std::process::Command;

use abi_support::{c_compilers, compile, golden_traces, root, run};
use jcas_core::config::Depots;
use jcas_core::{Cell, Config, Model};
use jcas_episode::{replay, trace};
use jcas_policy::{BaselineKind, PilotMode};

/// The output of `jcas trace record` for the mission of the C program's policy.
fn recorded_here() -> Vec<u8> {
    let depots = [Cell { x: 5, y: 5 }, Cell { x: 0, y: 11 }];
    let config = Config {
        uav_count: 6,
        hotspot_count: 3,
        range_min_m: Some(25.0),
        depots: Depots::from_slice(&depots).expect("two depots"),
        ..Config::default()
    };
    let model = Model::new(config).expect("legal");
    let mut policy = BaselineKind::Greedy
        .build(&model, PilotMode::Max)
        .expect("nothing is hidden");
    let mut text = Vec::new();
    trace::record(&model, &mut policy, 11, &mut text).expect("it flies");
    text
}

#[test]
fn the_example_records_what_its_host_owns() {
    for compiler in c_compilers() {
        let source = root().join("examples/c/external_mobility.c");
        let program = compile(compiler, "c11", "recording", &[source]);
        let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("flight-{compiler}.jsonl"));
        run(Command::new(program).arg(&file));
        let text = fs::read(file).expect("it was written");
        let flown = trace::read(text.as_slice()).expect("a whole trace");
        assert_eq!(trace::verify(&flown).expect("it flies"), None);
        assert_eq!(flown.header.policy, "external mobility");
        assert!(flown.steps.iter().all(|step| step.host.len() == 2));
    }
}

#[test]
fn c_records_what_the_command_records_and_what_a_host_supplied() {
    for compiler in c_compilers() {
        let source = root().join("tests/c/traces.c");
        let program = compile(compiler, "c11", "traces", &[source]);
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("recorded-{compiler}"));
        fs::create_dir_all(&folder).expect("the target folder can be written");
        run(Command::new(program).arg(&folder).args(golden_traces()));

        let flown = fs::read(folder.join("policy.jsonl")).expect("it was written");
        assert!(flown == recorded_here(), "{compiler}: other bytes");

        let text = fs::read_to_string(folder.join("hosted.jsonl")).expect("it was written");
        let hosted = trace::read(text.as_bytes()).expect("a whole trace");
        assert_eq!(trace::verify(&hosted).expect("it flies"), None);
        assert_eq!(hosted.header.policy, "a \"host\"\\\n\u{1}");
        assert_eq!(hosted.end.host.len(), 1);
        let calls: usize = hosted.steps.iter().map(|step| step.host.len()).sum();
        assert_eq!(calls, 3 + 2 + 2 * 6 + 1 + 8 + 9);
        let page = replay::page(&text).expect("a page");
        assert!(page.contains("\"moved_hotspots\":[[2,[4,4]]]"));
    }
}
