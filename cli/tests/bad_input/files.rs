//! Files: spoiled traces, folders that cannot be written.

use std::fs;

use crate::support::succeed;
use crate::{INPUT, IO, refuses};

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
            replaced("\"format_version\":1", "\"format_version\":3"),
            "format_version = 3: must be 1",
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
