//! Parts of a sweep, merged, are the sweep; what does not belong together is refused.

mod support;

use std::fs;
use std::path::Path;
use std::process::Output;

use support::{jcas, succeed};

/// Four cells.
const SWEEP: [&str; 8] = [
    "sweep",
    "--uavs",
    "3,5",
    "--hotspots",
    "3,5",
    "--episodes",
    "4",
    "--no-figures",
];

fn run_shard(folder: &Path, out: &str, shard: &str, more: &[&str]) -> Output {
    let options = ["--out", out, "--shard", shard];
    jcas(folder, &[&SWEEP, options.as_slice(), more].concat())
}

fn shard(folder: &Path, out: &str, shard: &str) {
    let output = run_shard(folder, out, shard, &[]);
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{shard}: {told}");
}

/// The manifests of all parts of a split.
fn manifests(out: &str, count: usize) -> Vec<String> {
    (1..=count)
        .map(|number| format!("{out}/shard-{number}-of-{count}.json"))
        .collect()
}

fn merge(folder: &Path, table: &str, shards: &[String]) -> Output {
    let shards: Vec<&str> = shards.iter().map(String::as_str).collect();
    jcas(folder, &[["merge", table].as_slice(), &shards].concat())
}

/// Merging is refused with a message that has all of these words, and writes nothing.
fn refuse_merge(folder: &Path, shards: &[String], words: &[&str]) {
    let output = merge(folder, "refused.csv", shards);
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    for word in words {
        assert!(told.contains(word), "{word}: {told}");
    }
    assert!(!folder.join("refused.csv").exists());
}

/// Seven shards of four cells: some have none.
#[test]
fn merged_shards_have_the_bytes_of_the_single_run() {
    let folder = tempfile::tempdir().unwrap();
    succeed(folder.path(), &SWEEP);
    let whole = fs::read(folder.path().join("out/results.csv")).unwrap();
    for count in [1, 2, 3, 7] {
        for number in 1..=count {
            shard(folder.path(), "parts", &format!("{number}/{count}"));
        }
        let mut shards = manifests("parts", count);
        shards.reverse();
        let table = format!("merged-{count}.csv");
        let output = merge(folder.path(), &table, &shards);
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{count}: {told}");
        let merged = fs::read(folder.path().join(&table)).unwrap();
        assert_eq!(merged, whole, "{count}");
    }
    // Equal values on an axis are cells of their own.
    let twice = ["--policy", "teams,teams"];
    succeed(
        folder.path(),
        &[&SWEEP, ["--out", "twice"].as_slice(), &twice].concat(),
    );
    for number in ["1/2", "2/2"] {
        assert!(
            run_shard(folder.path(), "parts2", number, &twice)
                .status
                .success()
        );
    }
    let output = merge(folder.path(), "twice.csv", &manifests("parts2", 2));
    assert!(output.status.success());
    let of = |path: &str| fs::read(folder.path().join(path)).unwrap();
    assert_eq!(of("twice.csv"), of("twice/results.csv"));
}

/// The single run finds the merged cells and draws them without another flight.
#[test]
fn the_sweep_continues_from_a_merged_table() {
    let folder = tempfile::tempdir().unwrap();
    for number in ["1/2", "2/2"] {
        shard(folder.path(), "out", number);
    }
    let table = folder.path().join("out/shard-1-of-2.csv");
    let text = fs::read_to_string(&table).unwrap();
    // No run gives this value: it shows that the row is kept.
    let line = text.lines().nth(1).unwrap();
    let kept = format!("{},0.123", line.rsplit_once(',').unwrap().0);
    fs::write(&table, text.replace(line, &kept)).unwrap();
    let merged = merge(folder.path(), "out/results.csv", &manifests("out", 2));
    assert!(merged.status.success());
    succeed(folder.path(), &SWEEP);
    let whole = fs::read_to_string(folder.path().join("out/results.csv")).unwrap();
    assert_eq!(whole.lines().nth(1), Some(kept.as_str()));
}

#[test]
fn a_shard_outside_its_range_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    for text in ["0/3", "4/3", "1/0", "x/2", "2"] {
        let output = run_shard(folder.path(), "out", text, &[]);
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(told.contains("--shard") && told.contains(text), "{told}");
        assert!(told.contains("1 <= i <= n"), "{told}");
    }
    assert!(!folder.path().join("out").exists());
}

#[test]
fn gaps_overlaps_and_other_splits_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for number in ["1/3", "2/3", "3/3", "1/2"] {
        shard(folder.path(), "a", number);
    }
    shard(folder.path(), "b", "2/3");
    let all = manifests("a", 3);
    let (first, second, third) = (all[0].clone(), all[1].clone(), all[2].clone());
    let gap = [first.clone(), third.clone()];
    let words = ["missing shard-2-of-3.json", &first, &third];
    refuse_merge(folder.path(), &gap, &words);

    let other = "b/shard-2-of-3.json".to_owned();
    let overlap = [first.clone(), second.clone(), other.clone(), third];
    let words = [&second, &other, "both are shard 2/3"];
    refuse_merge(folder.path(), &overlap, &words);

    let split = [first.clone(), "a/shard-1-of-2.json".to_owned()];
    let words = ["number of shards = 2: must be 3", &first, &split[1]];
    refuse_merge(folder.path(), &split, &words);
}

#[test]
fn shards_of_other_sweeps_and_builds_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    shard(folder.path(), "a", "1/2");
    shard(folder.path(), "a", "2/2");
    let first = "a/shard-1-of-2.json".to_owned();
    for more in [
        ["--seed", "2"],
        ["--set", "quorum=2"],
        ["--pilot", "max"],
        ["--vary", "horizon_steps=80"],
    ] {
        let output = run_shard(
            folder.path(),
            "b",
            "2/2",
            &[&more, ["--overwrite"].as_slice()].concat(),
        );
        assert!(output.status.success(), "{more:?}");
        let second = "b/shard-2-of-2.json".to_owned();
        let words = ["other sweep", &first, &second];
        refuse_merge(folder.path(), &[first.clone(), second.clone()], &words);
    }

    let path = folder.path().join("a/shard-2-of-2.json");
    let second = "a/shard-2-of-2.json".to_owned();
    let text = fs::read_to_string(&path).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
    for field in ["kernel", "executable"] {
        let own = manifest["build"][field].as_str().unwrap();
        fs::write(&path, text.replace(own, "0.0.9")).unwrap();
        let words = ["other build", "0.0.9", &first, &second];
        refuse_merge(folder.path(), &[first.clone(), second.clone()], &words);
        // Nor does this build continue rows of the other one.
        let output = run_shard(folder.path(), "a", "2/2", &[]);
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(
            told.contains("other build") && told.contains("--overwrite"),
            "{told}"
        );
    }
}

/// A policy on file counts with its content, not only with its name.
#[test]
fn a_policy_that_changed_between_shards_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let sizes = ["--preset", "search", "--uavs", "3", "--hotspots", "3"];
    let small = ["--set", "grid_width=8", "--set", "grid_height=7"];
    let options = [sizes.as_slice(), &small].concat();
    let plan = ["plan", "--iterations", "100", "--out", "plan.json"];
    succeed(folder.path(), &[&plan, options.as_slice()].concat());
    let path = folder.path().join("plan.json");
    for number in ["1/2", "2/2"] {
        let sweep = ["sweep", "--policy", "plan:plan.json", "--shard", number];
        succeed(folder.path(), &[&sweep, options.as_slice()].concat());
        // The plan keeps its name and its meaning; only its bytes change.
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, text + "\n").unwrap();
    }
    let words = [
        "other sweep",
        "out/shard-1-of-2.json",
        "out/shard-2-of-2.json",
    ];
    refuse_merge(folder.path(), &manifests("out", 2), &words);
}

/// What a crash leaves, a table with some rows or none, is refused and completed by the command.
#[test]
fn an_incomplete_shard_is_refused_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    shard(folder.path(), "out", "1/2");
    shard(folder.path(), "out", "2/2");
    let shards = manifests("out", 2);
    assert!(merge(folder.path(), "whole.csv", &shards).status.success());

    let table = folder.path().join("out/shard-2-of-2.csv");
    let text = fs::read_to_string(&table).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    fs::write(&table, format!("{}\n{}\n", lines[0], lines[2])).unwrap();
    let words = ["out/shard-2-of-2.csv", "holds 1 of the 2 cells"];
    refuse_merge(folder.path(), &shards, &words);
    // A row of another cell does not fill the gap, nor does the same row twice.
    fs::write(
        &table,
        format!("{}\n{}\n{}\n", lines[0], lines[2], lines[2]),
    )
    .unwrap();
    refuse_merge(
        folder.path(),
        &shards,
        &["out/shard-2-of-2.csv", "a cell that is none here"],
    );

    fs::write(&table, format!("{}\n{}\n", lines[0], lines[2])).unwrap();
    shard(folder.path(), "out", "2/2");
    assert_eq!(fs::read_to_string(&table).unwrap(), text);
    fs::remove_file(&table).unwrap();
    shard(folder.path(), "out", "2/2");
    assert_eq!(fs::read_to_string(&table).unwrap(), text);
}

#[test]
fn a_merge_keeps_another_table() {
    let folder = tempfile::tempdir().unwrap();
    shard(folder.path(), "out", "1/1");
    let shards = manifests("out", 1);
    let table = folder.path().join("table.csv");
    fs::write(&table, "mine\n").unwrap();
    let output = merge(folder.path(), "table.csv", &shards);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(fs::read_to_string(&table).unwrap(), "mine\n");
    succeed(
        folder.path(),
        &["merge", "table.csv", &shards[0], "--overwrite"],
    );
    // Merging again gives the same bytes and is no conflict.
    assert!(merge(folder.path(), "table.csv", &shards).status.success());
}

/// A shard that is killed leaves no table with half a row, and the same command completes it.
#[cfg(unix)]
#[test]
fn a_killed_shard_leaves_nothing_half_written() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let folder = tempfile::tempdir().unwrap();
    let quorums: Vec<String> = (1..=400).map(|quorum| quorum.to_string()).collect();
    let vary = format!("quorum={}", quorums.join(","));
    let mut killed = Command::new(assert_cmd::cargo::cargo_bin!("jcas"))
        .args(["sweep", "--uavs", "5", "--hotspots", "3", "--shard", "1/2"])
        .args(["--vary", &vary, "--episodes", "2000"])
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let table = folder.path().join("out/shard-1-of-2.csv");
    let started = Instant::now();
    while !table.exists() && started.elapsed() < Duration::from_secs(120) {
        std::thread::sleep(Duration::from_millis(20));
    }
    killed.kill().unwrap();
    killed.wait().unwrap();
    let text = fs::read_to_string(&table).unwrap();
    assert!(text.ends_with('\n'));
    let rows: Vec<usize> = text.lines().map(|line| line.split(',').count()).collect();
    assert!((2..200).contains(&rows.len()), "{}", rows.len());
    assert!(rows.iter().all(|&fields| fields == rows[0]));
    let shards = ["out/shard-1-of-2.json".to_owned()];
    refuse_merge(folder.path(), &shards, &["missing shard-2-of-2.json"]);
}

/// The array script in a loop over its tasks, then the merge script, as Slurm runs them.
#[cfg(unix)]
#[test]
fn the_cluster_scripts_give_the_single_run() {
    use std::process::Command;

    let folder = tempfile::tempdir().unwrap();
    succeed(folder.path(), &SWEEP);
    let binary = Path::new(assert_cmd::cargo::cargo_bin!("jcas"));
    let mut search = vec![binary.parent().unwrap().to_owned()];
    search.extend(std::env::split_paths(&std::env::var_os("PATH").unwrap()));
    let search = std::env::join_paths(search).unwrap();
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/cluster");
    let run = |script: &str, task: Option<usize>| {
        let mut command = Command::new("bash");
        command
            .arg(scripts.join(script))
            .env("PATH", &search)
            .env("SHARDS", "3")
            .env("SWEEP", SWEEP[1..].join(" "))
            .current_dir(folder.path());
        if let Some(task) = task {
            command.env("SLURM_ARRAY_TASK_ID", task.to_string());
        }
        let output = command.output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.success(), told)
    };
    for task in 1..=2 {
        let (done, told) = run("sweep.sbatch", Some(task));
        assert!(done, "{task}: {told}");
    }
    let (done, told) = run("merge.sbatch", None);
    assert!(!done && told.contains("shard-3-of-3.json"), "{told}");
    let (done, told) = run("sweep.sbatch", Some(3));
    assert!(done, "{told}");
    let (done, told) = run("merge.sbatch", None);
    assert!(done, "{told}");
    let of = |path: &str| fs::read(folder.path().join(path)).unwrap();
    assert_eq!(of("campaign/results.csv"), of("out/results.csv"));
}
