//! Files that attack the reader: control characters for the terminal, devices and pipes.

mod support;

use std::fs;
use std::path::Path;

use support::{jcas, succeed};

/// ESC, DEL, C1 and a mark that reverses the text, each as JSON and as raw text.
const ATTACKS: [(&str, &str); 4] = [
    ("\\u001b[31m", "\u{1b}[31m"),
    ("\\u007f", "\u{7f}"),
    ("\\u009b31m", "\u{9b}31m"),
    ("\\u202e", "\u{202e}"),
];

/// Runs a command that fails, and returns all that it prints.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = jcas(folder, arguments);
    assert!(!output.status.success(), "{arguments:?}");
    let text = [output.stdout, output.stderr].concat();
    String::from_utf8(text).unwrap()
}

fn is_clean(text: &str) -> bool {
    text.chars()
        .all(|c| c == '\n' || !c.is_control() && c != '\u{202e}')
}

#[test]
fn no_text_of_a_file_steers_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    succeed(folder.path(), &["trace", "record", "-o", "good.jsonl"]);
    let good = fs::read_to_string(path("good.jsonl")).unwrap();
    fs::create_dir(path("policy")).unwrap();
    for (json, raw) in ATTACKS {
        fs::write(path("c.toml"), format!("'{raw}' = 3\n")).unwrap();
        fs::write(path("c.json"), format!("{{\"{raw}\": 3}}")).unwrap();
        fs::write(path("p_d.csv"), format!("range_m,p{raw}\n1,2\n")).unwrap();
        fs::write(path("plan.json"), format!("{{\"for{json}mat\": 1}}")).unwrap();
        fs::write(
            path("policy/policy.json"),
            format!("{{\"{json}\": 1, \"format\": {{\"{json}\":2}}}}"),
        )
        .unwrap();
        fs::write(
            path("t.jsonl"),
            good.replacen("\"t\":1", &format!("\"t{json}\":1"), 1),
        )
        .unwrap();
        fs::write(
            path("shard-1-of-1.json"),
            format!("{{\"evaluation\": \"{json}\"}}"),
        )
        .unwrap();
        for arguments in [
            &["simulate", "--config", "c.toml"][..],
            &["simulate", "--config", "c.json"],
            &["simulate", "--radar-table", "p_d.csv"],
            &["simulate", "--policy", "plan:plan.json"],
            &["simulate", "--policy", "policy"],
            &["trace", "verify", "t.jsonl"],
            &["replay", "t.jsonl"],
            &["merge", "out.json", "shard-1-of-1.json"],
            &["simulate", "--policy", raw],
            &["simulate", "--set", &format!("quorum={raw}")],
            &["simulate", "--pilot", raw],
        ] {
            let text = refused(folder.path(), arguments);
            assert!(is_clean(&text), "{arguments:?}: {text:?}");
        }
    }
}

#[cfg(unix)]
#[test]
fn a_device_or_a_pipe_is_no_input() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let card = fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../policies/paper/policy.json"
    ))
    .unwrap();
    fs::create_dir(path("policy")).unwrap();
    fs::write(path("policy/policy.json"), card).unwrap();
    std::os::unix::fs::symlink("/dev/zero", path("policy/policy.safetensors")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", path("device")).unwrap();
    let made = std::process::Command::new("mkfifo")
        .arg(path("pipe"))
        .status();
    assert!(made.unwrap().success());
    for file in ["device", "pipe"] {
        for arguments in [
            &["simulate", "--config", file][..],
            &["simulate", "--radar-table", file],
            &["simulate", "--policy", &format!("plan:{file}")],
            &["trace", "verify", file],
            &["replay", file],
            &["merge", "out.json", file],
        ] {
            let text = refused(folder.path(), arguments);
            assert!(
                text.contains("must be a regular file"),
                "{arguments:?}: {text}"
            );
        }
    }
    let text = refused(folder.path(), &["simulate", "--policy", "policy"]);
    assert!(
        text.contains("policy.safetensors: must be a regular file"),
        "{text}"
    );
}
