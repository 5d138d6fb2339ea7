//! Training as a person meets it: stopped, killed, continued, exported.

mod support;

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use support::{lab, succeed};

const SMALL: [&str; 15] = [
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
    "--train-set=evaluation_episodes=2",
    "--name=small",
    "--threads=2",
];

fn start(folder: &Path, out: &str) -> Child {
    Command::new(assert_cmd::cargo::cargo_bin!("jcas-lab"))
        .args(SMALL)
        .args(["--out", out, "--resume"])
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the command runs")
}

fn policy(folder: &Path, out: &str) -> [Vec<u8>; 2] {
    ["policy.safetensors", "policy.json"]
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
    let child = Command::new(assert_cmd::cargo::cargo_bin!("jcas-lab"))
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

/// A run begins with the weights of another under its own settings, and does not continue the
/// other.
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
        let refused = lab(folder.path(), &[&short[..], more].concat());
        let told = String::from_utf8(refused.stderr).unwrap();
        assert_eq!(refused.status.code(), Some(code), "{told}");
        assert!(told.contains(named), "{told}");
        assert!(!folder.path().join("other").exists());
    }
}

/// The planner searches for hidden hotspots, so that no preset of training is for them.
#[test]
fn hidden_hotspots_are_left_to_the_planner() {
    let folder = tempfile::tempdir().unwrap();
    let search = ["train", "--preset=search", "--show-settings"];
    let refused = lab(folder.path(), &search);
    assert_eq!(refused.status.code(), Some(2));
    let told = String::from_utf8(refused.stderr).unwrap();
    assert!(told.contains("jcas plan"), "{told}");
    let named = [&search[..], &["--train-preset=tuned"]].concat();
    assert!(succeed(folder.path(), &named).contains("clip = 0.2"));
}
