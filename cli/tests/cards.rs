//! A trained policy runs as its card says, and the command reports what the options change.

mod support;

use std::fs;
use std::path::Path;

use serde_json::Value;
use support::{jcas, succeed};

/// A copy of the shipped policy that says it was trained on short episodes of three UAVs.
fn policy_of_short_missions(folder: &Path) {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../policies/mission");
    let target = folder.join("short");
    fs::create_dir(&target).unwrap();
    fs::copy(
        shipped.join("policy.safetensors"),
        target.join("policy.safetensors"),
    )
    .unwrap();
    let card = fs::read_to_string(shipped.join("policy.json")).unwrap();
    let mut card: Value = serde_json::from_str(&card).unwrap();
    for (field, value) in [("uav_count", 3), ("hotspot_count", 2), ("horizon_steps", 7)] {
        card["config"][field] = value.into();
    }
    // The runtime numbers the UAVs where the configuration has no tag.
    card["config"]["uav_tag"] = "off".into();
    fs::write(target.join("policy.json"), card.to_string()).unwrap();
}

fn hash(report: &str) -> String {
    let report: Value = serde_json::from_str(report).unwrap();
    report["config_hash"].as_str().unwrap().to_owned()
}

fn hash_of(folder: &Path, options: &[&str]) -> String {
    let simulate = ["simulate", "--policy=random", "--episodes=1", "--json"];
    hash(&succeed(folder, &[&simulate[..], options].concat()))
}

#[test]
fn a_trained_policy_flies_the_configuration_on_its_card_everywhere() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    policy_of_short_missions(folder);
    let own = hash_of(
        folder,
        &["--uavs=3", "--hotspots=2", "--set=horizon_steps=7"],
    );
    for command in [&["evaluate", "short"][..], &["simulate", "--policy=short"]] {
        let output = jcas(folder, &[command, &["--episodes=1", "--json"]].concat());
        assert_eq!(hash(&String::from_utf8(output.stdout).unwrap()), own);
        assert!(
            output.stderr.is_empty(),
            "{command:?}: nothing differs from the card"
        );
    }
    succeed(
        folder,
        &["trace", "record", "--policy=short", "-o", "flight.jsonl"],
    );
    let trace = fs::read_to_string(folder.join("flight.jsonl")).unwrap();
    assert!(
        trace.contains(&own),
        "the trace's header names the card's configuration"
    );
}

#[test]
fn a_pilot_density_that_is_asked_for_is_held() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    policy_of_short_missions(folder);
    let fly = |command: &[&str], pilot: &str| {
        let options = ["--episodes=1", "--json", "--pilot", pilot];
        jcas(folder, &[command, &options].concat())
    };
    for command in [&["evaluate", "short"][..], &["simulate", "--policy=short"]] {
        for (pilot, named, density) in [("0.2", "0.2", 0.2), ("max", "max", 0.3)] {
            let report: Value =
                serde_json::from_slice(&fly(command, pilot).stdout).expect("a report");
            assert_eq!(report["pilot"], named);
            let flown = report["pilot_density_mean"].as_f64().unwrap();
            assert!((flown - density).abs() < 1e-6, "{command:?}: {flown}");
        }
        let own: Value = serde_json::from_slice(&fly(command, "adaptive").stdout).unwrap();
        assert_eq!(own["pilot"], "learned");
        let card = fs::read_to_string(folder.join("short/policy.json")).unwrap();
        let density = "\"constant_pilot_density\":";
        let constant = card.replace(&format!("{density}null"), &format!("{density}0.05"));
        assert_ne!(card, constant);
        fs::write(folder.join("short/policy.json"), constant).unwrap();
        let own: Value = serde_json::from_slice(&fly(command, "adaptive").stdout).unwrap();
        assert_eq!(own["pilot"], "0.05");
        let flown = own["pilot_density_mean"].as_f64().unwrap();
        assert!((flown - 0.05).abs() < 1e-6, "{command:?}: {flown}");
        fs::write(folder.join("short/policy.json"), card).unwrap();
        let refused = fly(command, "0.9");
        let told = String::from_utf8(refused.stderr).unwrap();
        assert_eq!(refused.status.code(), Some(2), "{told}");
        assert!(told.contains("0.9") && told.contains("0.3"), "{told}");
    }
}

#[test]
fn what_the_options_change_of_a_card_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    policy_of_short_missions(folder);
    fs::write(folder.join("mine.toml"), "horizon_steps = 5\n").unwrap();
    for (options, like, said) in [
        (
            &["--uavs=2", "--set=quorum=1"][..],
            &[
                "--uavs=2",
                "--hotspots=2",
                "--set=horizon_steps=7",
                "--set=quorum=1",
            ][..],
            "short: its card's configuration, but uav_count = 2 (not 3), quorum = 1 (not 3)\n",
        ),
        (
            &["--preset=mission", "--set=horizon_steps=6"],
            &["--set=horizon_steps=6"],
            "uav_count = 10 (not 3), hotspot_count = 5 (not 2), horizon_steps = 6 (not 7)\n",
        ),
        (
            &["--config=mine.toml"],
            &["--config=mine.toml"],
            "uav_count = 10 (not 3), hotspot_count = 5 (not 2), horizon_steps = 5 (not 7)\n",
        ),
    ] {
        let evaluate = [&["evaluate", "short", "--episodes=1", "--json"], options].concat();
        let output = jcas(folder, &evaluate);
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(told.ends_with(said), "{options:?}: {told}");
        let report = String::from_utf8(output.stdout).unwrap();
        assert_eq!(hash(&report), hash_of(folder, like), "{options:?}");
    }
}

#[test]
fn a_sweep_says_where_its_missions_are_not_those_of_a_card() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    policy_of_short_missions(folder);
    let sweep = [
        "sweep",
        "--policy=short",
        "--uavs=2",
        "--hotspots=1",
        "--set=horizon_steps=4",
    ];
    let output = jcas(
        folder,
        &[&sweep[..], &["--episodes=1", "--no-figures"]].concat(),
    );
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(
        told.contains("short: its card's configuration, but horizon_steps = 4 (not 7)\n"),
        "{told}"
    );
    assert!(output.status.success(), "{told}");
}

/// Cards of other trainers lack our settings and evaluations, and have fields of their own.
#[test]
fn a_card_of_another_trainer_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    policy_of_short_missions(folder);
    let path = folder.join("short/policy.json");
    let evaluate = ["evaluate", "short", "--episodes=5", "--json"];
    let ours = succeed(folder, &evaluate);
    let mut card: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    let fields = card.as_object_mut().unwrap();
    for name in ["settings", "environment_steps", "evaluations"] {
        fields.remove(name).unwrap();
    }
    fields.insert("trainer".into(), "another".into());
    fs::write(&path, card.to_string()).unwrap();
    assert_eq!(succeed(folder, &evaluate), ours);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes without optimisation")]
fn a_trained_policy_flies_wherever_a_baseline_does() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = concat!(env!("CARGO_MANIFEST_DIR"), "/../policies/mission");
    let mission = ["--uavs=6", "--hotspots=2", "--seed=3"];
    let with = |arguments: &[&str]| succeed(folder.path(), &[arguments, &mission].concat());

    let simulated = with(&["simulate", "--policy", fleet, "--episodes=20", "--json"]);
    let evaluated = with(&["evaluate", fleet, "--episodes=20", "--json"]);
    assert_eq!(simulated, evaluated);
    let baseline = with(&["simulate", "--policy=random", "--episodes=20", "--json"]);
    assert_ne!(simulated, baseline);

    with(&["trace", "record", "--policy", fleet, "-o", "flight.jsonl"]);
    let told = succeed(folder.path(), &["trace", "verify", "flight.jsonl"]);
    assert!(told.starts_with("flight.jsonl: reproduced"), "{told}");
    with(&["replay", "--policy", fleet, "-o", "flight.html"]);
    let page = fs::read_to_string(folder.path().join("flight.html")).unwrap();
    assert!(page.contains("</html>"));

    // Targets that the policy has never had to look for.
    let refused = jcas(
        folder.path(),
        &["evaluate", fleet, "--set=target_visibility=hidden"],
    );
    assert_eq!(refused.status.code(), Some(2));
    let told = String::from_utf8(refused.stderr).unwrap();
    assert!(told.contains("target_visibility"), "{told}");
}
