//! The files: each trace has a test, a changed trace is found, and the page suffices.

use std::collections::BTreeSet;
use std::fs;
use std::io::ErrorKind;
use std::path::PathBuf;

use jcas_core::Config;
use jcas_core::hash::Fnv1a;
use jcas_episode::trace::{self, CHECKSUM};
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

/// Returns the line with another last digit in the number that comes after a text.
fn with_other_digit(line: &str, before: &str) -> String {
    let begin = line.find(before).expect(before) + before.len();
    let is_digit = |letter: char| letter.is_ascii_hexdigit() || "+-.".contains(letter);
    let length = line[begin..].find(|letter| !is_digit(letter));
    let last = begin + length.expect("more follows a number") - 1;
    let other = if &line[last..=last] == "1" { "2" } else { "1" };
    format!("{}{other}{}", &line[..last], &line[last + 1..])
}

/// Replaces the checksum by that of the text before it.
fn with_checksum(text: &str) -> String {
    let covered = &text[..text.rfind(CHECKSUM).expect("a checksum")];
    let mut hash = Fnv1a::new();
    hash.write(covered.as_bytes());
    format!("{covered}{CHECKSUM}{:016x}\"}}\n", hash.finish())
}

/// A changed trace is detected wherever the change is.
#[test]
fn any_changed_field_is_caught() {
    let honest = read("completion");
    let (first, last) = (0, honest.steps.len() + 1);
    for (field, line, before) in [
        ("config_hash", first, "\"config_hash\":\"0x"),
        ("initial.state_hash", first, "\"state_hash\":\"0x"),
        ("positions[0][0]", 5, "\"positions\":[["),
        ("battery_uj[0]", 5, "\"battery_uj\":["),
        ("throughput", 5, "\"throughput\":"),
        ("reward.spread", 5, "\"spread\":"),
        ("observation_hash", 5, "\"observation_hash\":\"0x"),
        ("metrics.moves", last, "\"moves\":"),
    ] {
        let mut lines: Vec<String> = honest.text.lines().map(str::to_owned).collect();
        lines[line] = with_other_digit(&lines[line], before);
        let text = with_checksum(&(lines.join("\n") + "\n"));
        let changed = trace::read(text.as_bytes()).expect(field);
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
