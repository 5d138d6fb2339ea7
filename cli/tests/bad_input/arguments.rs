//! Arguments: unknown names, numbers out of range, options without effect.

use std::fs;

use crate::{INPUT, refuses};

#[test]
fn unknown_names() {
    let folder = tempfile::tempdir().unwrap();
    refuses(
        folder.path(),
        &["simulate", "--preset", "letter"],
        INPUT,
        &["'letter'", "mission, paper"],
    );
    refuses(
        folder.path(),
        &["simulate", "--policy", "clever"],
        INPUT,
        &[
            "policy = clever",
            "random, untrained, greedy, teams, squads, line, answer, plan, replan, plan:FILE",
        ],
    );
    refuses(
        folder.path(),
        &["simulate", "--pilot", "most"],
        INPUT,
        &["pilot = most", "min, mid, max, adaptive, or a density"],
    );
    refuses(
        folder.path(),
        &["simulate", "--pilot", "0.4"],
        INPUT,
        &[
            "pilot = 0.4",
            "0.01 (pilot_density_min)",
            "0.3 (pilot_density_max)",
        ],
    );
    refuses(
        folder.path(),
        &[
            "simulate",
            "--policy",
            "greedy",
            "--set",
            "target_visibility=hidden",
        ],
        INPUT,
        &[
            "policy = greedy",
            "target_visibility = hidden",
            "random, untrained, line, answer, plan, replan",
        ],
    );
}

#[test]
fn folders_without_a_policy() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("empty")).unwrap();
    let choices = "answer, plan, replan, plan:FILE, or the folder of a trained policy";
    for (policy, reason) in [
        ("runs/absent", "no such folder"),
        ("empty", "holds no policy.json"),
        ("clever", "no such folder"),
    ] {
        let name = format!("policy = {policy}");
        let parts = [name.as_str(), choices, reason];
        for command in [
            ["simulate", "--policy", policy].as_slice(),
            &["evaluate", policy],
            &["evaluate", policy, "--mode", "sampled"],
            &["replay", "--policy", policy],
            &["sweep", "--policy", policy],
        ] {
            refuses(folder.path(), command, INPUT, &parts);
        }
    }
}

#[test]
fn options_without_effect() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, option, applies) in [
        ("replay flight.jsonl --uavs 5", "--uavs", "without TRACE"),
        (
            "replay flight.jsonl --set quorum=2",
            "--set",
            "without TRACE",
        ),
        (
            "replay flight.jsonl --preset paper",
            "--preset",
            "without TRACE",
        ),
        (
            "replay flight.jsonl --pilot max",
            "--pilot",
            "without TRACE",
        ),
        (
            "replay flight.jsonl --episode-seed 3",
            "--episode-seed",
            "without TRACE",
        ),
        (
            "replay --policy plan --pilot max",
            "--pilot",
            "to baselines",
        ),
        ("evaluate teams --mode sampled", "--mode", "trained policy"),
        ("evaluate plan --pilot max", "--pilot", "to baselines"),
        (
            "simulate --policy replan --pilot 0.1",
            "--pilot",
            "to baselines",
        ),
        (
            "trace record -o x.jsonl --policy plan --pilot max",
            "--pilot",
            "to baselines",
        ),
        ("plan --altitude-m 30", "--altitude-m", "with --geojson"),
        ("plan --depot 48.1,11.5", "--depot", "with --geojson"),
        ("plan --hotspot 3,8 --seed 2", "--seed", "with --page"),
    ] {
        let words: Vec<&str> = arguments.split(' ').collect();
        refuses(
            folder.path(),
            &words,
            INPUT,
            &[option, "has no effect", applies],
        );
    }
}

#[test]
fn more_threads_than_a_machine_has() {
    let folder = tempfile::tempdir().unwrap();
    refuses(
        folder.path(),
        &["simulate", "--episodes", "2", "--threads", "100000"],
        INPUT,
        &["--threads", "100000", "0..=1024"],
    );
}

#[test]
fn negative_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let u64_range = "a whole number from 0 to 18446744073709551615";
    for (arguments, option, range) in [
        (
            "simulate --uavs -3",
            "--uavs",
            "a whole number from 1 to 4096",
        ),
        (
            "simulate --hotspots -3",
            "--hotspots",
            "a whole number from 1 to ",
        ),
        (
            "simulate --episodes -3",
            "--episodes",
            "a whole number from 1 to ",
        ),
        ("simulate --seed -3", "--seed", u64_range),
        ("simulate --threads -3", "--threads", "0..=1024"),
        (
            "simulate --pilot -0.1",
            "pilot = -0.1",
            "0.3 (pilot_density_max)",
        ),
        ("evaluate teams --seed -3", "--seed", u64_range),
        (
            "sweep --uavs -3,5",
            "--uavs",
            "a whole number from 1 to 4096",
        ),
        (
            "sweep --hotspots -3",
            "--hotspots",
            "a whole number from 1 to ",
        ),
        (
            "sweep --pilot -0.1,0.2",
            "pilot = -0.1",
            "0.3 (pilot_density_max)",
        ),
        ("plan --iterations -3", "--iterations", u64_range),
        ("plan --hotspot -1,2", "--hotspot", "a column and a row"),
        ("plan --time-limit -3", "--time-limit", "a number above 0"),
        ("replay --episode -3", "--episode", u64_range),
        (
            "replay --episode-seed -3",
            "--episode-seed",
            "hexadecimal digits",
        ),
        ("bench --environments -3", "--environments", "1..=65536"),
        ("bench --seconds -3", "seconds = -3", "0.01 to 3600"),
        ("play --port -3", "--port", "0..=65535"),
        (
            "tour --episodes -3",
            "--episodes",
            "a whole number from 1 to ",
        ),
    ] {
        let words: Vec<&str> = arguments.split(' ').collect();
        refuses(folder.path(), &words, INPUT, &[option, range]);
    }
}
