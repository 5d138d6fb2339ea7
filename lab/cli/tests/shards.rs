//! Shards of a reproduction, merged, are the reproduction; what does not belong together is
//! refused.

mod support;

use std::fs;
use std::path::Path;
use std::process::Output;

use support::{lab, succeed};

/// Scripts and plans at two fleet sizes.
const REPRODUCE: [&str; 7] = [
    "reproduce",
    "--quick",
    "--only",
    "baselines,comparison",
    "--uavs=5,6",
    "--hotspots=1",
    "--threads=2",
];

fn reproduce(folder: &Path, more: &[&str]) -> Output {
    lab(folder, &[&REPRODUCE, more].concat())
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn shard(folder: &Path, out: &str, shard: &str) {
    let output = reproduce(folder, &["--out", out, "--shard", shard]);
    assert!(output.status.success(), "{shard}: {}", told(&output));
}

fn manifests(out: &str, count: usize) -> Vec<String> {
    (1..=count)
        .map(|number| format!("{out}/shard-{number}-of-{count}.json"))
        .collect()
}

fn merge(folder: &Path, out: &str, shards: &[String]) -> Output {
    let shards: Vec<&str> = shards.iter().map(String::as_str).collect();
    lab(folder, &[["merge", out].as_slice(), &shards].concat())
}

/// Merging is refused with a message that has all of these words, and writes nothing.
fn refuse_merge(folder: &Path, shards: &[String], words: &[&str]) {
    let output = merge(folder, "refused", shards);
    let told = told(&output);
    assert_eq!(output.status.code(), Some(2), "{told}");
    for word in words {
        assert!(told.contains(word), "{word}: {told}");
    }
    assert!(!folder.join("refused").exists());
}

#[test]
fn merged_shards_are_the_single_run_and_go_on_as_one() {
    let folder = tempfile::tempdir().unwrap();
    succeed(
        folder.path(),
        &[&REPRODUCE, ["--out", "whole"].as_slice()].concat(),
    );
    for number in 1..=3 {
        shard(folder.path(), "parts", &format!("{number}/3"));
    }
    // No shard draws pages or touches the tables of the whole.
    for name in ["results.csv", "comparison.csv", "report.html"] {
        assert!(!folder.path().join("parts").join(name).exists(), "{name}");
    }
    let merged = merge(folder.path(), "parts", &manifests("parts", 3));
    assert!(merged.status.success(), "{}", told(&merged));
    let of = |path: &str| fs::read(folder.path().join(path)).unwrap();
    for name in ["results.csv", "comparison.csv"] {
        assert!(
            of(&format!("whole/{name}")) == of(&format!("parts/{name}")),
            "{name}"
        );
    }
    // The single run finds every result on file, and makes the same page of them.
    let output = reproduce(folder.path(), &["--out", "parts"]);
    assert!(output.status.success(), "{}", told(&output));
    for name in ["results.csv", "comparison.csv", "results.md"] {
        assert!(
            of(&format!("whole/{name}")) == of(&format!("parts/{name}")),
            "{name}"
        );
    }
    // Merging again is no conflict; another table is kept.
    assert!(
        merge(folder.path(), "parts", &manifests("parts", 3))
            .status
            .success()
    );
    fs::write(folder.path().join("parts/results.csv"), "mine\n").unwrap();
    let output = merge(folder.path(), "parts", &manifests("parts", 3));
    assert_eq!(output.status.code(), Some(2));
    assert!(told(&output).contains("--overwrite"), "{}", told(&output));
    assert_eq!(of("parts/results.csv"), b"mine\n");
}

#[test]
fn shards_that_do_not_belong_together_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let scripts = ["--only=baselines", "--out"];
    let fly = |out: &str, number: &str, more: &[&str]| {
        let shard = [out, "--shard", number];
        let few = [
            "reproduce",
            "--quick",
            "--uavs=5",
            "--hotspots=1",
            "--threads=2",
        ];
        lab(
            folder.path(),
            &[&few, scripts.as_slice(), &shard, more].concat(),
        )
    };
    for number in ["1/3", "2/3", "3/3", "1/2"] {
        let output = fly("a", number, &[]);
        assert!(output.status.success(), "{number}: {}", told(&output));
    }
    let all = manifests("a", 3);
    let (first, second, third) = (all[0].clone(), all[1].clone(), all[2].clone());

    let gap = [first.clone(), third.clone()];
    refuse_merge(folder.path(), &gap, &["missing shard-2-of-3.json", &third]);

    assert!(fly("b", "2/3", &[]).status.success());
    let other = "b/shard-2-of-3.json".to_owned();
    let overlap = [first.clone(), second.clone(), other.clone(), third.clone()];
    refuse_merge(folder.path(), &overlap, &["both are shard 2/3", &other]);

    let split = [first.clone(), "a/shard-1-of-2.json".to_owned()];
    let words = ["number of shards = 2: must be 3", &split[1]];
    refuse_merge(folder.path(), &split, &words);

    let fleet = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../policies/fleet");
    let given = format!("--policy={}", fleet.display());
    for more in ["--seeds=2", "--paper-hotspots=2", &given] {
        fs::remove_dir_all(folder.path().join("b")).unwrap();
        assert!(fly("b", "2/3", &[more]).status.success(), "{more}");
        let words = ["other reproduction", &first, &other];
        refuse_merge(folder.path(), &[first.clone(), other.clone()], &words);
    }

    // A shard that is not at its end, as after a crash, is refused; its command completes it.
    let path = folder.path().join(&second);
    let text = fs::read_to_string(&path).unwrap();
    let mut manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
    manifest["rows"] = serde_json::Value::Null;
    fs::write(&path, manifest.to_string()).unwrap();
    refuse_merge(folder.path(), &all, &[&second, "is not finished"]);
    assert!(fly("a", "2/3", &[]).status.success());
    assert_eq!(fs::read_to_string(&path).unwrap(), text);
    assert!(merge(folder.path(), "whole", &all).status.success());

    for field in ["kernel", "executable"] {
        let own = manifest["build"][field].as_str().unwrap();
        fs::write(&path, text.replace(own, "0.0.9")).unwrap();
        refuse_merge(folder.path(), &all, &["other build", "0.0.9", &second]);
        // Nor does this build continue rows of the other one.
        let output = fly("a", "2/3", &[]);
        assert_eq!(output.status.code(), Some(2), "{}", told(&output));
        assert!(told(&output).contains("other build"), "{}", told(&output));
    }
}

#[test]
fn a_shard_outside_its_range_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    for text in ["0/3", "4/3", "1/0", "x/2", "2"] {
        let output = reproduce(folder.path(), &["--out", "out", "--shard", text]);
        let told = told(&output);
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(told.contains("--shard") && told.contains(text), "{told}");
        assert!(told.contains("1 <= i <= n"), "{told}");
    }
    assert!(!folder.path().join("out").exists());
}
