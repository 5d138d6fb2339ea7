//! `jcas plan` writes plans whose episodes match their stated expectation.

mod support;

use std::fs;
use std::path::Path;

use serde_json::Value;
use support::{jcas, succeed};

const SMALL: [&str; 10] = [
    "--preset",
    "search",
    "--uavs",
    "6",
    "--hotspots",
    "3",
    "--set",
    "grid_width=8",
    "--set",
    "grid_height=7",
];

fn plan(folder: &Path, more: &[&str]) -> Value {
    let mut arguments = vec!["plan"];
    arguments.extend(SMALL);
    arguments.extend(["--iterations", "5000", "--json"]);
    arguments.extend(more);
    serde_json::from_str(&succeed(folder, &arguments)).expect("the output is JSON")
}

#[test]
fn a_plan_takes_what_it_says() {
    let folder = tempfile::tempdir().unwrap();
    let report = plan(folder.path(), &[]);
    let expected = report["expected_steps"].as_f64().unwrap();
    assert!(report["bound_steps"].as_f64().unwrap() <= expected);
    assert_eq!(report["stopped"], false);
    let flown = succeed(
        folder.path(),
        &[
            "simulate",
            "--policy",
            "plan:plan.json",
            "--episodes",
            "2000",
            "--json",
        ],
    );
    let flown: Value = serde_json::from_str(&flown).unwrap();
    assert_eq!(flown["uavs"], 6);
    assert_eq!(flown["config_hash"], report["config_hash"]);
    let half = 0.5
        * (flown["mission_steps_mean_high"].as_f64().unwrap()
            - flown["mission_steps_mean_low"].as_f64().unwrap());
    let mean = flown["mission_steps_mean"].as_f64().unwrap();
    // Two half intervals are four standard errors.
    assert!((mean - expected).abs() < 2.0 * half, "{mean} {expected}");
}

#[test]
fn a_plan_depends_on_its_seed_alone() {
    let folder = tempfile::tempdir().unwrap();
    let read = || fs::read(folder.path().join("plan.json")).unwrap();
    plan(folder.path(), &[]);
    let first = read();
    plan(folder.path(), &[]);
    assert_eq!(first, read());
    plan(folder.path(), &["--plan-seed", "2"]);
    assert_ne!(first, read());
}

#[test]
fn a_time_limit_ends_the_annealing_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let mut arguments = vec!["plan"];
    arguments.extend(SMALL);
    arguments.extend(["--iterations", "1000000000", "--time-limit", "0.2"]);
    let text = succeed(folder.path(), &arguments);
    assert!(text.contains("The annealing was ended after"), "{text}");
    assert!(folder.path().join("plan.json").exists());
}

#[test]
fn every_file_of_a_plan_is_written() {
    let folder = tempfile::tempdir().unwrap();
    plan(
        folder.path(),
        &[
            "--picture",
            "plan.svg",
            "--page",
            "plan.html",
            "--geojson",
            "plan.geojson",
            "--qgroundcontrol",
            "flights",
            "--depot",
            "48.137,11.575",
        ],
    );
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(read("plan.svg").matches("<polyline").count(), 6);
    assert!(read("plan.html").contains("<html"));
    let lines: Value = serde_json::from_str(&read("plan.geojson")).unwrap();
    let start = &lines["features"][5]["geometry"]["coordinates"][0];
    assert_eq!(*start, serde_json::json!([11.575, 48.137, 50.0]));
    let mission: Value = serde_json::from_str(&read("flights/uav-6.plan")).unwrap();
    assert_eq!(mission["fileType"], "Plan");
    let items = mission["mission"]["items"].as_array().unwrap();
    let commands: Vec<&Value> = items.iter().map(|item| &item["command"]).collect();
    assert_eq!(
        (commands[0], commands[commands.len() - 1]),
        (&22.into(), &20.into())
    );
    // A cell to the north is fifty metres of latitude.
    let north = items.iter().map(|item| item["params"][4].as_f64().unwrap());
    let most = north.fold(0.0, f64::max);
    let cells = (most - 48.137).to_radians() * 6_371_008.8 / 50.0;
    assert!(
        (cells - cells.round()).abs() < 1e-6 && cells > 0.5,
        "{cells}"
    );
}

#[test]
fn known_hotspots_are_planned_and_replanned() {
    let folder = tempfile::tempdir().unwrap();
    let mission = [
        "--preset",
        "paper",
        "--uavs",
        "6",
        "--hotspots",
        "2",
        "--set",
        "grid_width=8",
    ];
    let mut arguments = vec![
        "plan",
        "--iterations",
        "5000",
        "--hotspot",
        "1,1",
        "--hotspot",
        "6,9",
    ];
    arguments.extend(mission);
    succeed(folder.path(), &arguments);
    let file: Value =
        serde_json::from_slice(&fs::read(folder.path().join("plan.json")).unwrap()).unwrap();
    assert_eq!(file["hotspots"], serde_json::json!([[1, 1], [6, 9]]));
    let mut times = Vec::new();
    for policy in ["plan", "replan"] {
        let mut arguments = vec!["simulate", "--episodes", "10", "--json", "--policy", policy];
        arguments.extend(mission);
        let report: Value = serde_json::from_str(&succeed(folder.path(), &arguments)).unwrap();
        assert_eq!(report["pilot"], "planned");
        times.push(report["mission_steps_mean"].as_f64().unwrap());
    }
    assert!(times.iter().all(|&time| time < 30.0), "{times:?}");
}

#[test]
fn a_plan_of_another_mission_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    plan(folder.path(), &[]);
    let output = jcas(
        folder.path(),
        &["simulate", "--policy", "plan:plan.json", "--uavs", "7"],
    );
    assert_eq!(output.status.code(), Some(2));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(errors.contains("made for the configuration"), "{errors}");
    let output = jcas(
        folder.path(),
        &["plan", "--preset", "paper", "--hotspot", "1,1"],
    );
    assert_eq!(output.status.code(), Some(2));
}
