//! Every command does what its help says.

mod support;

use std::fs;
use std::path::Path;

use serde_json::Value;
use support::{jcas, succeed};

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("the output is JSON")
}

#[test]
fn simulate_reports_every_quantity_with_its_interval() {
    let folder = tempfile::tempdir().unwrap();
    let report = json(&succeed(
        folder.path(),
        &["simulate", "--episodes", "40", "--json"],
    ));
    assert_eq!(report["episodes"], 40);
    for name in [
        "success_rate",
        "mission_steps_mean",
        "energy_kwh_mean",
        "co2_kg_mean",
        "throughput_mean",
    ] {
        let value = report[name].as_f64().unwrap();
        let low = report[format!("{name}_low")].as_f64().unwrap();
        let high = report[format!("{name}_high")].as_f64().unwrap();
        assert!(
            low <= value && value <= high,
            "{name}: {low} {value} {high}"
        );
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let with = |threads| {
        succeed(
            folder.path(),
            &[
                "simulate",
                "--episodes",
                "50",
                "--json",
                "--threads",
                threads,
            ],
        )
    };
    let one = with("1");
    assert_eq!(one, with("2"));
    assert_eq!(one, with("7"));
}

#[test]
fn a_recorded_mission_is_reproduced_and_played() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = ["--uavs", "6", "--policy", "random", "--seed", "9"];
    succeed(
        folder.path(),
        &[&["trace", "record", "-o", "a.jsonl"], fleet.as_slice()].concat(),
    );
    let told = succeed(folder.path(), &["trace", "verify", "a.jsonl"]);
    assert_eq!(told, "a.jsonl: reproduced, 100 steps\n");

    // The first episode of the campaign with that seed is the same one.
    let first = [
        &["simulate", "--episodes", "1", "--trace", "b.jsonl"],
        fleet.as_slice(),
    ];
    succeed(folder.path(), &first.concat());
    assert_eq!(
        succeed(folder.path(), &["trace", "diff", "a.jsonl", "b.jsonl"]),
        "equal\n"
    );

    succeed(folder.path(), &["replay", "a.jsonl", "-o", "page.html"]);
    let page = fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert!(page.starts_with("<!doctype html>") || page.starts_with("<!DOCTYPE html>"));
}

#[test]
fn differences_are_named_and_exit_with_1() {
    let folder = tempfile::tempdir().unwrap();
    for (seed, name) in [("1", "a.jsonl"), ("2", "b.jsonl")] {
        succeed(
            folder.path(),
            &["trace", "record", "--seed", seed, "-o", name],
        );
    }
    let output = jcas(folder.path(), &["trace", "diff", "a.jsonl", "b.jsonl"]);
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(
        told.starts_with("first difference: header, seed: "),
        "{told}"
    );

    let output = jcas(
        folder.path(),
        &["trace", "diff", "a.jsonl", "b.jsonl", "--json"],
    );
    assert_eq!(output.status.code(), Some(1));
    let told = json(&String::from_utf8(output.stdout).unwrap());
    assert_eq!(told["equal"], false);
    assert_eq!(told["difference"]["field"], "seed");
}

#[test]
fn a_sweep_goes_on_where_it_was_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = [
        "sweep",
        "--uavs",
        "3,5",
        "--hotspots",
        "3,5",
        "--episodes",
        "8",
        "--no-figures",
    ];
    succeed(folder.path(), &sweep);
    let table = folder.path().join("out/results.csv");
    let whole = fs::read_to_string(&table).unwrap();
    assert_eq!(whole.lines().count(), 1 + 4);

    // Ctrl-C leaves some cells on file and others not. A value that no run gives shows that the
    // rows on file are kept and not run again.
    let lines: Vec<&str> = whole.lines().collect();
    let success = lines[0]
        .split(',')
        .position(|name| name == "success_rate")
        .unwrap();
    let mut fields: Vec<&str> = lines[2].split(',').collect();
    fields[success] = "0.123";
    let kept = fields.join(",");
    fs::write(&table, format!("{}\n{kept}\n{}\n", lines[0], lines[4])).unwrap();
    succeed(folder.path(), &sweep);
    let resumed = fs::read_to_string(&table).unwrap();
    assert_eq!(resumed, whole.replace(lines[2], &kept));
}

// A policy that was trained again has its old name, and other results.
#[test]
fn a_sweep_does_not_go_on_with_another_policy_of_the_same_name() {
    let folder = tempfile::tempdir().unwrap();
    let mine = folder.path().join("mine");
    fs::create_dir(&mine).unwrap();
    let take = |shipped: &str| {
        let from = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../policies")
            .join(shipped);
        for name in ["policy.json", "policy.safetensors"] {
            fs::copy(from.join(name), mine.join(name)).unwrap();
        }
    };
    let sweep = [
        "sweep",
        "--policy",
        "mine,teams",
        "--episodes",
        "2",
        "--no-figures",
    ];
    take("mission");
    succeed(folder.path(), &sweep);
    let table = folder.path().join("out/results.csv");
    let whole = fs::read(&table).unwrap();
    succeed(folder.path(), &sweep);
    assert_eq!(fs::read(&table).unwrap(), whole);

    take("paper");
    let output = jcas(folder.path(), &sweep);
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(
        told.contains("holds the results of another sweep: policy_hash is 0x"),
        "{told}"
    );
    assert!(told.contains("--overwrite"), "{told}");
    assert_eq!(fs::read(&table).unwrap(), whole);
}

#[test]
fn a_sweep_draws_and_plays() {
    let folder = tempfile::tempdir().unwrap();
    let told = json(&succeed(
        folder.path(),
        &[
            "sweep",
            "--uavs",
            "3,5",
            "--hotspots",
            "3",
            "--vary",
            "horizon_steps=20,40",
            "--policy",
            "greedy,teams",
            "--episodes",
            "4",
            "--json",
            "--out",
            "results",
        ],
    ));
    assert_eq!(told["cells"].as_array().unwrap().len(), 8);
    let written: Vec<&str> = told["written"]
        .as_array()
        .unwrap()
        .iter()
        .map(|path| path.as_str().unwrap())
        .collect();
    // The folder holds four quantities over two numeric lists in two formats, the table and the
    // page.
    assert_eq!(written.len(), 4 * 2 * 2 + 2);
    for path in written {
        assert!(
            fs::metadata(folder.path().join(path)).unwrap().len() > 100,
            "{path}"
        );
    }
}

#[test]
fn shown_configurations_read_back_as_themselves() {
    let folder = tempfile::tempdir().unwrap();
    for format in ["toml", "json"] {
        let name = format!("shown.{format}");
        let show = [
            "config", "show", "--preset", "paper", "--uavs", "7", "--format", format,
        ];
        let text = succeed(folder.path(), &show);
        fs::write(folder.path().join(&name), &text).unwrap();
        assert_eq!(
            succeed(
                folder.path(),
                &["config", "show", "--config", &name, "--format", format]
            ),
            text
        );
        let told = succeed(folder.path(), &["config", "check", &name]);
        assert!(told.contains("valid, configuration hash 0x"), "{told}");
    }
}

#[test]
fn single_fields_come_after_the_file_and_the_file_after_the_preset() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("mine.toml"),
        "quorum = 2\nhorizon_steps = 60\ninform_payment = \"once\"\n",
    )
    .unwrap();
    let shown = json(&succeed(
        folder.path(),
        &[
            "config",
            "show",
            "--preset",
            "paper",
            "--config",
            "mine.toml",
            "--set",
            "horizon_steps=70",
            "--set",
            "cell_size_m=40",
            "--json",
        ],
    ));
    assert_eq!(shown["charge_billing"], "nameplate");
    assert_eq!(shown["inform_payment"], "once");
    assert_eq!(shown["quorum"], 2);
    assert_eq!(shown["horizon_steps"], 70);
    assert_eq!(shown["cell_size_m"], 40.0);
}

#[test]
fn presets_differ_in_what_they_are_said_to() {
    let folder = tempfile::tempdir().unwrap();
    let told = succeed(folder.path(), &["config", "presets"]);
    assert!(
        told.contains("charge_billing") && told.contains("inform_payment"),
        "{told}"
    );
    assert!(!told.contains("uav_count"), "{told}");
    // An absent field that nothing is derived for is absent, not another field's derived value.
    let ranges = told.lines().find(|line| line.contains("sensing_range_m"));
    let ranges: Vec<&str> = ranges.unwrap_or_default().split_whitespace().collect();
    assert_eq!(ranges, ["sensing_range_m", "none", "150", "150", "none"]);
}

#[test]
fn bench_divides_the_time_of_a_step() {
    let folder = tempfile::tempdir().unwrap();
    let told = json(&succeed(
        folder.path(),
        &[
            "bench",
            "--uavs",
            "4",
            "--environments",
            "3",
            "--seconds",
            "0.05",
            "--json",
        ],
    ));
    assert!(told["env_steps"].as_u64().unwrap() > 0);
    let shares: f64 = told["phases"]
        .as_array()
        .unwrap()
        .iter()
        .map(|phase| phase["share"].as_f64().unwrap())
        .sum();
    assert!((shares - 1.0).abs() < 1e-9, "{shares}");
}

#[test]
fn every_command_has_help_with_examples_or_commands() {
    let folder = tempfile::tempdir().unwrap();
    for command in [
        ["simulate"].as_slice(),
        &["sweep"],
        &["merge"],
        &["trace", "record"],
        &["trace", "verify"],
        &["trace", "diff"],
        &["replay"],
        &["config", "show"],
        &["config", "check"],
        &["bench"],
    ] {
        let help = succeed(folder.path(), &[command, ["--help"].as_slice()].concat());
        assert!(help.contains("Examples:"), "{command:?}");
    }
    assert!(succeed(folder.path(), &["--help"]).contains("Exit codes:"));
}

/// After Ctrl-C the finished cells are on file, the message says how to resume, and the exit code
/// is that of a shell.
#[cfg(unix)]
#[test]
fn an_interrupted_sweep_keeps_its_finished_cells() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let folder = tempfile::tempdir().unwrap();
    let quorums: Vec<String> = (1..=400).map(|quorum| quorum.to_string()).collect();
    let sweep = Command::new(assert_cmd::cargo::cargo_bin!("jcas"))
        .args([
            "sweep",
            "--uavs",
            "5",
            "--hotspots",
            "3",
            "--no-figures",
            "--vary",
        ])
        .arg(format!("quorum={}", quorums.join(",")))
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let table = folder.path().join("out/results.csv");
    let started = Instant::now();
    while !table.exists() && started.elapsed() < Duration::from_secs(120) {
        std::thread::sleep(Duration::from_millis(20));
    }
    let pid = sweep.id();
    assert!(
        Command::new("sh")
            .args(["-c", &format!("kill -INT {pid}")])
            .status()
            .unwrap()
            .success()
    );
    let output = sweep.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{told}");
    assert!(
        told.contains("the same command goes on from there"),
        "{told}"
    );
    let rows = fs::read_to_string(&table).unwrap().lines().count() - 1;
    assert!((1..400).contains(&rows), "{rows}");
    assert!(told.contains(&format!("{rows} of 400 cells")), "{told}");
}

#[test]
fn the_seed_in_a_header_flies_the_episode_again() {
    let folder = tempfile::tempdir().unwrap();
    let record = [
        "trace",
        "record",
        "--seed",
        "3",
        "--episode",
        "5",
        "-o",
        "a.jsonl",
    ];
    succeed(folder.path(), &record);
    let text = fs::read_to_string(folder.path().join("a.jsonl")).unwrap();
    let seed = json(text.lines().next().unwrap())["seed"].clone();
    let again = [
        "trace",
        "record",
        "-o",
        "b.jsonl",
        "--episode-seed",
        seed.as_str().unwrap(),
    ];
    succeed(folder.path(), &again);
    assert_eq!(
        fs::read_to_string(folder.path().join("b.jsonl")).unwrap(),
        text
    );
}

#[test]
fn an_episode_is_played_without_a_trace_on_file() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["--uavs", "3", "--seed", "2"];
    let told = succeed(folder.path(), &[&["replay"], options.as_slice()].concat());
    assert_eq!(told, "replay.html\n");
    let record = [&["trace", "record", "-o", "a.jsonl"], options.as_slice()].concat();
    succeed(folder.path(), &record);
    succeed(folder.path(), &["replay", "a.jsonl", "-o", "b.html"]);
    let page = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(page("replay.html"), page("b.html"));
}

#[test]
fn every_preset_flies_its_default_policy() {
    let folder = tempfile::tempdir().unwrap();
    for (preset, policy) in [
        ("mission", "teams"),
        ("paper", "teams"),
        ("search", "line"),
        ("isac", "answer"),
    ] {
        let arguments = ["simulate", "--preset", preset, "--episodes", "2"];
        let told = succeed(folder.path(), &arguments);
        assert!(told.contains(&format!("policy {policy}")), "{told}");
        assert!(told.contains(&format!("preset {preset}.")), "{told}");
        succeed(folder.path(), &["replay", "--preset", preset]);
        succeed(
            folder.path(),
            &["trace", "record", "--preset", preset, "-o", "t.jsonl"],
        );
    }
    let told = succeed(
        folder.path(),
        &["simulate", "--episodes", "1", "--set", "quorum=2"],
    );
    assert!(
        told.contains("preset mission with quorum = 2 (not 3)."),
        "{told}"
    );
}

#[test]
fn the_readme_shows_what_its_commands_print() {
    let readme = include_str!("../../README.md");
    let (_, block) = readme.split_once("```console\n").unwrap();
    let (block, _) = block.split_once("```").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut commands = 0;
    for part in block.split("$ cargo run --release -p jcas-cli -- ").skip(1) {
        let (command, shown) = part.split_once('\n').unwrap();
        let arguments: Vec<&str> = command.split(' ').collect();
        let printed = succeed(folder.path(), &arguments);
        assert_eq!(shown.trim_end(), printed.trim_end(), "{command}");
        commands += 1;
    }
    assert_eq!(commands, 2);
}

#[test]
fn every_report_names_preset_hash_and_command() {
    let folder = tempfile::tempdir().unwrap();
    let small = ["--preset=search", "--set=horizon_steps=9", "--uavs=3"];
    for command in [
        ["simulate", "--episodes=2"].as_slice(),
        &["plan", "--iterations=10"],
        &["sweep", "--episodes=1", "--hotspots=3", "--no-figures"],
    ] {
        let arguments = [command, small.as_slice()].concat();
        let line = format!("jcas {}", arguments.join(" "));
        let report = json(&succeed(
            folder.path(),
            &[&arguments[..], &["--json"]].concat(),
        ));
        let preset = report["preset"].as_str().unwrap();
        assert!(preset.starts_with("preset search with "), "{preset}");
        let hash = report["config_hash"].as_str().unwrap();
        let told = succeed(folder.path(), &arguments);
        assert!(
            told.contains(&format!("Configuration {hash}: {preset}")),
            "{told}"
        );
        assert!(told.contains(&format!("\nCommand: {line}\n")), "{told}");
    }
    let arguments = ["evaluate", "teams", "--episodes=1", "--set=quorum=2"];
    let told = succeed(folder.path(), &arguments);
    assert!(
        told.contains("\nCommand: jcas evaluate teams --episodes=1 --set=quorum=2\n"),
        "{told}"
    );
}

#[test]
fn a_quorum_above_the_fleet_gets_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let output = jcas(
        folder.path(),
        &["simulate", "--episodes", "1", "--uavs", "2"],
    );
    assert!(output.status.success());
    let said = String::from_utf8_lossy(&output.stderr);
    let warning = "warning: quorum = 3 is above uav_count = 2: no hotspot can be confirmed";
    assert!(said.contains(warning), "{said}");
}

/// Each row of the table names fields and as many defaults.
#[test]
fn symbols_of_the_model_page() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/model.md");
    let page = fs::read_to_string(page).unwrap();
    let table = page.split("\n## Symbols\n").nth(1).unwrap();
    let table = table.split("\n## ").next().unwrap();
    let config = jcas_core::Config::default();
    let defaults = config.values();
    let mut checked = 0;
    for row in table
        .lines()
        .filter(|line| line.contains('`') && line.starts_with('|'))
    {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let fields: Vec<&str> = cells[2]
            .split(", ")
            .map(|name| name.trim_matches('`'))
            .collect();
        let written: Vec<&str> = cells[3].split(", ").collect();
        assert_eq!(fields.len(), written.len(), "{row}");
        for (field, written) in fields.into_iter().zip(written) {
            let names = &mut jcas_core::Config::FIELDS.iter();
            let index = names.position(|info| info.name == field).unwrap();
            let default = defaults[index];
            if default.is_derived() {
                assert_eq!(written, "derived", "{row}");
            } else {
                let default: f64 = default.to_string().parse().unwrap();
                assert_eq!(written.parse::<f64>().unwrap(), default, "{row}");
            }
            checked += 1;
        }
    }
    assert!(checked > 40, "{checked} fields");
}
