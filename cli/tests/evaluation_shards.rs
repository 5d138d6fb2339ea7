//! Parts of an evaluation, merged, are the evaluation; what does not belong together is refused.

mod support;

use std::fs;
use std::path::Path;

use support::{jcas, succeed};

const EVALUATION: [&str; 8] = [
    "evaluate",
    "teams",
    "--uavs",
    "4",
    "--hotspots",
    "3",
    "--episodes",
    "7",
];

fn shard(folder: &Path, out: &str, shard: &str, more: &[&str]) -> String {
    let options = ["--out", out, "--shard", shard];
    succeed(folder, &[&EVALUATION, options.as_slice(), more].concat())
}

/// The command is refused with a message that has all of these words.
fn refuse(folder: &Path, arguments: &[&str], words: &[&str]) {
    let output = jcas(folder, arguments);
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
    for word in words {
        assert!(told.contains(word), "{word}: {told}");
    }
}

/// Nine shards of seven episodes: two have none.
#[test]
fn merged_shards_have_the_bytes_of_the_single_run() {
    let folder = tempfile::tempdir().unwrap();
    let whole = succeed(
        folder.path(),
        &[&EVALUATION, ["--json"].as_slice()].concat(),
    );
    for count in [1, 2, 9] {
        let mut merge = vec!["merge".to_owned(), format!("report-{count}.json")];
        for number in 1..=count {
            let told = shard(folder.path(), "parts", &format!("{number}/{count}"), &[]);
            assert!(told.contains("of 7 episodes"), "{told}");
            merge.insert(2, format!("parts/shard-{number}-of-{count}.json"));
        }
        let arguments: Vec<&str> = merge.iter().map(String::as_str).collect();
        succeed(folder.path(), &arguments);
        let merged = fs::read_to_string(folder.path().join(&merge[1])).unwrap();
        assert_eq!(merged, whole, "{count}");
        // Merging again gives the same bytes and is no conflict.
        succeed(folder.path(), &arguments);
    }
    refuse(
        folder.path(),
        &["merge", "report-1.json", "parts/shard-1-of-2.json"],
        &["missing shard-2-of-2.json"],
    );
}

/// A shard that is on file is not flown again.
#[test]
fn a_shard_on_file_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let told = shard(folder.path(), "out", "1/2", &[]);
    let path = folder.path().join("out/shard-1-of-2.json");
    // No episode gives this value: it shows that the file is kept.
    let text = fs::read_to_string(&path).unwrap();
    let kept = text.replacen("\"moves\": ", "\"moves\": 9", 1);
    assert_ne!(text, kept);
    fs::write(&path, &kept).unwrap();
    assert_eq!(shard(folder.path(), "out", "1/2", &[]), told);
    assert_eq!(fs::read_to_string(&path).unwrap(), kept);
    shard(folder.path(), "out", "1/2", &["--overwrite"]);
    assert_eq!(fs::read_to_string(&path).unwrap(), text);
}

#[test]
fn shards_that_do_not_belong_together_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = ("a/shard-1-of-2.json", "a/shard-2-of-2.json");
    shard(folder.path(), "a", "1/2", &[]);
    shard(folder.path(), "a", "2/2", &[]);
    shard(folder.path(), "b", "2/2", &[]);
    let other = "b/shard-2-of-2.json";
    refuse(
        folder.path(),
        &["merge", "r.json", first, second, other],
        &[second, other, "both are shard 2/2"],
    );
    for (more, named) in [
        (["--seed", "2"], "seed = 2"),
        (["--set", "quorum=2"], "config_hash"),
        (["--pilot", "max"], "pilot = max"),
        (["--episodes", "8"], "episodes = 8: must be 7"),
    ] {
        let arguments = [&more, ["--overwrite"].as_slice()].concat();
        if more[0] == "--episodes" {
            let command = ["evaluate", "teams", "--uavs", "4", "--hotspots", "3"];
            let shard = ["--out", "b", "--shard", "2/2"];
            succeed(
                folder.path(),
                &[&command, arguments.as_slice(), &shard].concat(),
            );
        } else {
            shard(folder.path(), "b", "2/2", &arguments);
        }
        let merge = ["merge", "r.json", first, other];
        refuse(folder.path(), &merge, &["other evaluation", named, other]);
        // Nor does the folder's own command take that file for its own.
        let again = ["--out", "b", "--shard", "2/2"];
        refuse(
            folder.path(),
            &[&EVALUATION, again.as_slice()].concat(),
            &["other evaluation", other, "--overwrite"],
        );
    }
    let path = folder.path().join(second);
    let text = fs::read_to_string(&path).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
    let own = manifest["build"]["executable"].as_str().unwrap();
    fs::write(&path, text.replace(own, "0x0")).unwrap();
    let merge = ["merge", "r.json", first, second];
    refuse(folder.path(), &merge, &["other build", "0x0", second]);
    // A part that lacks episodes, and a part of a sweep.
    let mut short = manifest.clone();
    short["missions"].as_array_mut().unwrap().pop();
    fs::write(&path, short.to_string()).unwrap();
    refuse(
        folder.path(),
        &merge,
        &[second, "2 episodes: must be 3, shard 2/2 of 7"],
    );
    let sweep = ["sweep", "--uavs", "4", "--hotspots", "3", "--episodes", "2"];
    let part = ["--shard", "2/2", "--out", "a", "--overwrite"];
    succeed(folder.path(), &[&sweep, part.as_slice()].concat());
    refuse(folder.path(), &merge, &[second, "an evaluation's shard"]);
    assert!(!folder.path().join("r.json").exists());
}

/// A policy on file counts with its content, not only with its name.
#[test]
fn a_policy_that_changed_between_shards_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../policies/mission");
    fs::create_dir(folder.path().join("mine")).unwrap();
    for name in ["policy.json", "policy.safetensors"] {
        fs::copy(shipped.join(name), folder.path().join("mine").join(name)).unwrap();
    }
    let card = folder.path().join("mine/policy.json");
    for number in ["1/2", "2/2"] {
        let command = ["evaluate", "mine", "--episodes", "2", "--shard", number];
        succeed(folder.path(), &command);
        // The card keeps its meaning; only its bytes change.
        let text = fs::read_to_string(&card).unwrap();
        fs::write(&card, text + "\n").unwrap();
    }
    let merge = [
        "merge",
        "r.json",
        "out/shard-1-of-2.json",
        "out/shard-2-of-2.json",
    ];
    refuse(folder.path(), &merge, &["other evaluation", "policy_files"]);
}

#[test]
fn options_of_a_shard_need_one() {
    let folder = tempfile::tempdir().unwrap();
    for option in [["--out", "x"].as_slice(), &["--overwrite"]] {
        let words = [option[0], "has no effect", "with --shard"];
        refuse(folder.path(), &[&EVALUATION, option].concat(), &words);
    }
    let both = ["--json", "--shard", "1/2"];
    let words = ["--json", "has no effect", "without --shard"];
    refuse(
        folder.path(),
        &[&EVALUATION, both.as_slice()].concat(),
        &words,
    );
}
