//! Training as a person meets it: stopped, killed, continued; and its policies wherever a baseline can fly.

mod support;

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use support::{jcas, succeed};

const SMALL: [&str; 19] = [
    "train",
    "--uavs=3",
    "--hotspots=2",
    "--steps=40960",
    "--train-set=network=mlp",
    "--train-set=actor_hidden=[32]",
    "--train-set=critic_hidden=[32]",
    "--train-set=environments=8",
    "--train-set=workers=4",
    "--train-set=batch_steps=256",
    "--train-set=minibatch_rows=256",
    "--train-set=critic_minibatch_rows=128",
    "--train-set=shard_rows=128",
    "--train-set=checkpoint_every=1",
    "--train-set=evaluate_every=5",
    "--train-set=evaluation_episodes=2",
    "--train-set=kl_max=none",
    "--name=small",
    "--threads=2",
];

fn start(folder: &Path, out: &str) -> Child {
    Command::new(assert_cmd::cargo::cargo_bin!("jcas"))
        .args(SMALL)
        .args(["--out", out, "--resume"])
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the command runs")
}

fn policy(folder: &Path, out: &str) -> [Vec<u8>; 3] {
    ["policy.safetensors", "policy.json", "policy.onnx"]
        .map(|file| fs::read(folder.join(out).join(file)).expect("the policy is written"))
}

/// `kill -9` again and again, a little later each time, until a run gets to its end by itself.
#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes without optimisation")]
fn a_run_that_is_killed_at_any_moment_ends_with_the_same_files() {
    let folder = tempfile::tempdir().unwrap();
    succeed(folder.path(), &[&SMALL[..], &["--out", "whole"]].concat());
    let mut kills = 0;
    loop {
        let mut child = start(folder.path(), "killed");
        std::thread::sleep(Duration::from_millis(60 + 45 * kills));
        if child
            .try_wait()
            .unwrap()
            .is_some_and(|status| status.success())
        {
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
    }
    assert!(kills > 2, "killed only {kills} times");
    assert_eq!(
        policy(folder.path(), "whole"),
        policy(folder.path(), "killed")
    );
}

#[cfg(unix)]
#[test]
fn ctrl_c_saves_and_says_how_to_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let mut endless = SMALL.to_vec();
    endless[3] = "--steps=100000000";
    let child = Command::new(assert_cmd::cargo::cargo_bin!("jcas"))
        .args(endless)
        .args(["--out", "run"])
        .current_dir(folder.path())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let checkpoint = folder.path().join("run/checkpoint.safetensors");
    while !checkpoint.exists() {
        std::thread::sleep(Duration::from_millis(20));
    }
    let interrupted = Command::new("sh")
        .args(["-c", &format!("kill -INT {}", child.id())])
        .status();
    assert!(interrupted.unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(told.contains("go on with --resume"), "{told}");
    assert!(checkpoint.exists());
}

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes without optimisation")]
fn a_trained_policy_flies_wherever_a_baseline_does() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = concat!(env!("CARGO_MANIFEST_DIR"), "/../policies/fleet");
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

/// A run begins with the weights of another, under settings of its own, and is no continuation of it.
#[test]
fn training_goes_on_from_another_run() {
    let folder = tempfile::tempdir().unwrap();
    let mut short = SMALL.to_vec();
    short[3] = "--steps=512";
    succeed(folder.path(), &[&short[..], &["--out", "taught"]].concat());
    let from = ["--out=begun", "--from=taught", "--train-set=discount=0.9"];
    short[3] = "--steps=0";
    succeed(folder.path(), &[&short[..], &from].concat());
    assert_eq!(
        policy(folder.path(), "taught")[0],
        policy(folder.path(), "begun")[0]
    );
    for (more, code, named) in [
        (&["--out=taught", "--from=taught"][..], 2, "--resume"),
        (&["--out=other", "--from=nowhere"], 3, "nowhere"),
        (&["--out=other", "--from=taught", "--resume"], 2, "--from"),
    ] {
        let refused = jcas(folder.path(), &[&short[..], more].concat());
        let told = String::from_utf8(refused.stderr).unwrap();
        assert_eq!(refused.status.code(), Some(code), "{told}");
        assert!(told.contains(named), "{told}");
        assert!(!folder.path().join("other").exists());
    }
}

/// Other trainers know neither our settings nor our evaluations, and tell more of their own.
#[test]
fn a_card_of_another_trainer_is_read() {
    let folder = tempfile::tempdir().unwrap();
    succeed(folder.path(), &[&SMALL[..], &["--out", "run"]].concat());
    let path = folder.path().join("run/policy.json");
    let evaluate = ["evaluate", "run", "--episodes=5", "--json"];
    let ours = succeed(folder.path(), &evaluate);
    let mut card: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    let fields = card.as_object_mut().unwrap();
    for name in ["settings", "environment_steps", "evaluations"] {
        fields.remove(name).unwrap();
    }
    fields.insert("trainer".into(), "another".into());
    fs::write(&path, card.to_string()).unwrap();
    assert_eq!(succeed(folder.path(), &evaluate), ours);
}
