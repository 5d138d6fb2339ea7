//! The files: each trace has a test, a changed trace is found, and the page suffices.

use std::collections::BTreeSet;
use std::fs;
use std::io::ErrorKind;
use std::path::PathBuf;

use jcas_core::Config;
use jcas_episode::trace::{self, Trace};
use serde_json::Value;

use crate::abi_support::skip;
use crate::support::{folder, read};

/// Every trace has a test and a line in the script that records it, and every test has a trace.
#[test]
fn every_trace_has_its_test_and_its_line() {
    let files: BTreeSet<String> = fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter_map(|name| name.strip_suffix(".jsonl").map(str::to_owned))
        .collect();
    let script = fs::read_to_string(folder().join("record.sh")).unwrap();
    let recorded: BTreeSet<String> = script
        .lines()
        .filter_map(|line| line.strip_prefix("record "))
        .filter_map(|line| line.split_whitespace().next())
        .map(str::to_owned)
        .collect();
    let tests = [
        include_str!("charging.rs"),
        include_str!("endings.rs"),
        include_str!("false_alarms.rs"),
        include_str!("fleets.rs"),
        include_str!("readings.rs"),
        include_str!("searching.rs"),
    ]
    .concat();
    let tested: BTreeSet<String> = files
        .iter()
        .filter(|name| tests.contains(&format!("reproduced(\"{name}\")")))
        .cloned()
        .collect();
    assert_eq!(files, recorded);
    assert_eq!(files, tested);
}

/// A changed trace is detected wherever the change is.
#[test]
fn any_changed_field_is_caught() {
    let honest = read("completion");
    type Change = (&'static str, fn(&mut Trace));
    let changes: [Change; 8] = [
        ("config_hash", |trace| trace.header.config_hash.0 ^= 1),
        ("initial.state_hash", |trace| {
            trace.header.initial.state_hash.0 ^= 1
        }),
        ("positions[0][0]", |trace| {
            trace.steps[4].positions[0].x ^= 1
        }),
        ("battery_uj[9]", |trace| trace.steps[4].battery_uj[9] += 1),
        ("throughput", |trace| {
            let bits = trace.steps[4].throughput.to_bits();
            trace.steps[4].throughput = f64::from_bits(bits ^ 1);
        }),
        ("reward.spread", |trace| trace.steps[4].reward.0[9] += 1e-9),
        ("observation_hash", |trace| {
            trace.steps[4].observation_hash.0 ^= 1
        }),
        ("metrics.moves", |trace| trace.end.metrics.moves += 1),
    ];
    for (field, change) in changes {
        let mut changed = honest.clone();
        change(&mut changed);
        let found = trace::verify(&changed).unwrap().expect(field);
        assert_eq!(found.field, field);
        assert_eq!(trace::diff(&honest, &changed).unwrap().field, field);
    }
}

/// The configuration in a trace is complete, but for the fields that are derived from others.
#[test]
fn headers_hold_every_field() {
    let path = folder().join("completion.jsonl");
    let text = fs::read_to_string(path).unwrap();
    let header: Value = serde_json::from_str(text.lines().next().unwrap()).unwrap();
    let config = read("completion").header.config;
    for (info, value) in Config::FIELDS.iter().zip(config.values()) {
        let stated = header["config"].get(info.name).is_some();
        assert_eq!(stated, !value.is_derived(), "{}", info.name);
    }
}

/// A script that follows only `docs/model.md` rebuilds every trace.
#[test]
fn the_page_is_enough_to_rebuild_every_trace() {
    let script = folder().join("../rebuild/rebuild.py");
    let traces = fs::read_dir(folder())
        .expect("the golden traces are there")
        .map(|entry| entry.expect("a readable folder").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "jsonl"));
    let rebuilding = std::process::Command::new("python3")
        .arg(&script)
        .args(traces)
        .output();
    let output = match rebuilding {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return skip("python3 is not installed");
        }
        rebuilding => rebuilding.expect("python3 runs"),
    };
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    // The script refuses a trace with another seed.
    let other = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("other_seed.jsonl");
    let text = fs::read_to_string(folder().join("one_uav.jsonl")).expect("a golden trace");
    let at = text.find("\"seed\":\"0x").expect("a seed") + 10;
    let digit = if &text[at..=at] == "0" { "1" } else { "0" };
    let changed = format!("{}{digit}{}", &text[..at], &text[at + 1..]);
    fs::write(&other, changed).expect("the target folder can be written");
    let output = std::process::Command::new("python3")
        .arg(&script)
        .arg(&other)
        .output()
        .expect("python3 runs");
    assert!(!output.status.success());
}
