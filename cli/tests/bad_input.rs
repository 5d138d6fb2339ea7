//! Every wrong input gives a message that names it, its value and the allowed ones, and an exit
//! code for its kind.

mod support;

use std::fs;
use std::path::Path;

use support::{jcas, succeed};

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

#[test]
fn fields_out_of_range() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, parts) in [
        (["--uavs", "0"], ["uav_count = 0", "1 to 4096"]),
        (
            ["--hotspots", "144"],
            ["hotspot_count = 144", "at most 143"],
        ),
        (
            ["--set", "pilot_density_min=0.5"],
            ["pilot_density_min = 0.5", "at most 0.3"],
        ),
        (
            ["--set", "move_energy_kwh=-0.001"],
            ["move_energy_kwh = -0.001", "from 0 to 1"],
        ),
        (
            ["--set", "cell_size_m=nan"],
            ["cell_size_m = NaN", "0.001 to 1000000"],
        ),
        (
            ["--set", "cell_size_m=inf"],
            ["cell_size_m = inf", "0.001 to 1000000"],
        ),
        (
            ["--set", "uav_count=2.5"],
            ["uav_count = 2.5", "a whole number from 1 to 4096"],
        ),
        (
            ["--set", "uav_count=-5"],
            ["uav_count = -5", "a whole number from 1 to 4096"],
        ),
        (
            ["--set", "target_visibility=seen"],
            ["target_visibility = \"seen\"", "one of known, hidden"],
        ),
        (
            ["--set", "uav_cout=5"],
            ["uav_cout: no such field", "did you mean uav_count?"],
        ),
        (["--set", "uav_count"], ["--set uav_count", "field=value"]),
    ] {
        let arguments = [&["simulate", "--episodes", "1"], arguments.as_slice()].concat();
        refuses(folder.path(), &arguments, INPUT, &parts);
    }
}

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
            "random, greedy, swarm, teams, sweep, line, frontier, relay, charging, clean",
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
            "swarm",
            "--set",
            "target_visibility=hidden",
        ],
        INPUT,
        &[
            "policy = swarm",
            "target_visibility = hidden",
            "random, sweep, line, frontier, relay",
        ],
    );
}

#[test]
fn folders_without_a_policy() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("empty")).unwrap();
    let choices = "clean, plan, replan, plan:FILE, or the folder of a trained policy";
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

#[test]
fn configuration_files() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text, parts) in [
        (
            "nan.toml",
            "cell_size_m = nan\n",
            ["cell_size_m = NaN", "0.001 to 1000000"],
        ),
        (
            "nan.json",
            "{\"cell_size_m\": NaN}",
            ["nan.json", "line 1 column"],
        ),
        (
            "negative.toml",
            "battery_capacity_kwh = -0.2\n",
            ["battery_capacity_kwh = -0.2", "0.000001"],
        ),
        (
            "type.json",
            "{\"uav_count\": \"many\"}",
            ["uav_count = \"many\"", "a whole number"],
        ),
        (
            "unknown.toml",
            "uavs = 5\n",
            ["unknown.toml", "uavs: no such field"],
        ),
        (
            "broken.toml",
            "uav_count = = 5\n",
            ["broken.toml", "line 1"],
        ),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
        refuses(folder.path(), &["config", "check", name], INPUT, &parts);
        refuses(
            folder.path(),
            &["simulate", "--config", name],
            INPUT,
            &parts,
        );
    }
    refuses(
        folder.path(),
        &["config", "check", "absent.toml"],
        IO,
        &["absent.toml", "No such file"],
    );
}

/// Spoiled copies of a recorded trace: name, text, and a part of the refusal.
fn spoiled(good: &str) -> Vec<(&'static str, String, &'static str)> {
    let lines: Vec<&str> = good.lines().collect();
    let replaced = |from: &str, to: &str| good.replacen(from, to, 1);
    vec![
        ("empty.jsonl", String::new(), "is empty"),
        (
            "cut.jsonl",
            lines[..lines.len() - 1].join("\n") + "\n",
            "truncated: it stops after 100 whole steps",
        ),
        (
            "middle.jsonl",
            good[..good.len() / 2].to_owned(),
            "truncated: it stops after",
        ),
        (
            "version.jsonl",
            replaced("\"format_version\":2", "\"format_version\":3"),
            "format_version = 3: this build reads versions 1 to 2",
        ),
        (
            "changed.jsonl",
            replaced("\"co2_ng\":0", "\"co2_ng\":1"),
            "was changed after recording",
        ),
        (
            "number.jsonl",
            replaced("\"t\":2,", "\"t\":\"two\","),
            "line 3: invalid type: string \"two\"",
        ),
        (
            "skipped.jsonl",
            replaced("\"t\":2,", "\"t\":3,"),
            "line 3: t = 3: must be 2",
        ),
        (
            "extended.jsonl",
            good.to_owned() + lines[1] + "\n",
            "the end line must be the last",
        ),
        (
            "other.jsonl",
            "{\"kind\":\"header\",\"format\":\"xyz\"}\n".to_owned(),
            "must be the header of a jcas-trace file",
        ),
        (
            "text.jsonl",
            "hello\n".to_owned(),
            "must be the header of a jcas-trace file",
        ),
    ]
}

#[test]
fn traces() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    succeed(
        folder.path(),
        &["trace", "record", "--uavs", "4", "-o", "good.jsonl"],
    );
    let good = fs::read_to_string(path("good.jsonl")).unwrap();
    for (name, text, part) in spoiled(&good) {
        fs::write(path(name), text).unwrap();
        for command in [
            &["trace", "verify", name][..],
            &["trace", "diff", "good.jsonl", name],
            &["replay", name],
        ] {
            refuses(folder.path(), command, INPUT, &[name, part]);
        }
        assert!(!path("replay.html").exists(), "{name} left a page behind");
    }
    refuses(
        folder.path(),
        &["trace", "verify", "absent.jsonl"],
        IO,
        &["absent.jsonl", "No such file"],
    );
}

#[test]
fn folders_that_cannot_be_written() {
    let folder = tempfile::tempdir().unwrap();
    // A file stands where a folder is needed, so that even root cannot write there.
    fs::write(folder.path().join("file"), "").unwrap();
    refuses(
        folder.path(),
        &[
            "sweep",
            "--uavs",
            "5",
            "--hotspots",
            "3",
            "--out",
            "file/out",
        ],
        IO,
        &["file/out"],
    );
    refuses(
        folder.path(),
        &["trace", "record", "-o", "file/trace.jsonl"],
        IO,
        &["file/trace.jsonl"],
    );
    refuses(
        folder.path(),
        &[
            "simulate",
            "--episodes",
            "1",
            "--trace",
            "absent/trace.jsonl",
        ],
        IO,
        &["absent/trace.jsonl", "No such file"],
    );
    refuses(
        folder.path(),
        &["replay", "-o", "absent/page.html"],
        IO,
        &["absent/page.html"],
    );
}

#[test]
fn results_of_another_sweep_are_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = [
        "sweep",
        "--uavs",
        "5",
        "--hotspots",
        "3",
        "--episodes",
        "2",
        "--no-figures",
    ];
    succeed(folder.path(), &sweep);
    let before = fs::read(folder.path().join("out/results.csv")).unwrap();
    for other in [
        ["--seed", "2"].as_slice(),
        &["--set", "horizon_steps=50"],
        &["--vary", "quorum=2,3"],
    ] {
        let arguments = [&sweep, other].concat();
        refuses(
            folder.path(),
            &arguments,
            INPUT,
            &["results.csv", "another sweep", "--overwrite"],
        );
        assert_eq!(
            fs::read(folder.path().join("out/results.csv")).unwrap(),
            before
        );
    }
    succeed(
        folder.path(),
        &[&sweep, ["--seed", "2", "--overwrite"].as_slice()].concat(),
    );
    assert_ne!(
        fs::read(folder.path().join("out/results.csv")).unwrap(),
        before
    );
}

#[test]
fn lists_of_a_sweep() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, parts) in [
        (["--vary", "quorum"], ["--vary quorum", "field=value,value"]),
        (["--vary", "uav_count=3,4"], ["uav_count", "listed twice"]),
        (["--uavs", "5,0"], ["uav_count = 0", "1 to 4096"]),
        (["--policy", "swarm,clever"], ["policy = clever", "teams"]),
        (
            ["--vary", "cell_size_m=50,nan"],
            ["cell_size_m = NaN", "0.001"],
        ),
    ] {
        let arguments = [&["sweep", "--episodes", "1"], arguments.as_slice()].concat();
        refuses(folder.path(), &arguments, INPUT, &parts);
        assert!(!folder.path().join("out").exists());
    }
}
