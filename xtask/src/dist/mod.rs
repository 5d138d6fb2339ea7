//! `cargo xtask dist`: what users without Rust install, for all platforms that are served.
//!
//! The same commit gives the same files. It needs cargo-zigbuild and Zig for Linux, and mingw-w64
//! for Windows; `.ci/dist.sh` installs them.

mod archive;
mod build;
mod package;
mod targets;

use std::path::{Path, PathBuf};
use std::process::Command;

use archive::Tree;
use targets::{System, TARGETS, Target};

const VERSION: &str = env!("CARGO_PKG_VERSION");

struct Options {
    targets: Vec<&'static Target>,
    out: PathBuf,
}

/// Writes the archives of all platforms, or of those after `--target`, into `dist`, or the folder
/// after `--out`.
pub fn run(arguments: &[String]) -> Result<bool, String> {
    let options = parse(arguments)?;
    let epoch = epoch()?;
    let mut files = Vec::new();
    for target in options.targets {
        let built = build::build(target, epoch)?;
        files.push(packed(target, &package::tree(target, &built)?, epoch)?);
    }
    write(&options.out, &files)?;
    Ok(true)
}

/// The platform's archive, with its name.
fn packed(target: &Target, tree: &Tree, epoch: u32) -> Result<(String, Vec<u8>), String> {
    let root = format!("jcas-{VERSION}-{}", target.name);
    let (name, bytes) = match target.system {
        System::Linux => (
            format!("{root}.tar.gz"),
            archive::tar_gz(&root, tree, epoch).map_err(|error| error.to_string()),
        ),
        System::Windows => (
            format!("{root}.zip"),
            archive::zip(&root, tree).map_err(|error| error.to_string()),
        ),
    };
    Ok((name, bytes?))
}

fn parse(arguments: &[String]) -> Result<Options, String> {
    let mut options = Options {
        targets: Vec::new(),
        out: PathBuf::from("dist"),
    };
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        let mut value = || {
            rest.next()
                .ok_or(format!("{argument} needs a value after it"))
        };
        match argument.as_str() {
            "--target" => options.targets.push(Target::find(value()?)?),
            "--out" => options.out = PathBuf::from(value()?),
            other => {
                return Err(format!(
                    "{other}: there are --target TRIPLE and --out FOLDER"
                ));
            }
        }
    }
    if options.targets.is_empty() {
        options.targets = TARGETS.iter().collect();
    }
    Ok(options)
}

/// The time of the last commit, or `SOURCE_DATE_EPOCH`, in seconds since 1970.
fn epoch() -> Result<u32, String> {
    let text = match std::env::var("SOURCE_DATE_EPOCH") {
        Ok(text) => text,
        Err(_) => {
            let output = Command::new("git")
                .args(["log", "-1", "--format=%ct"])
                .output()
                .map_err(|error| format!("git does not start: {error}"))?;
            String::from_utf8_lossy(&output.stdout).into_owned()
        }
    };
    text.trim()
        .parse()
        .map_err(|error| format!("the time of the commit, {text:?}: {error}"))
}

/// Writes the files and their checksums into the folder. What else lies there stays.
fn write(out: &Path, files: &[(String, Vec<u8>)]) -> Result<(), String> {
    let said = |error: std::io::Error| format!("{}: {error}", out.display());
    std::fs::create_dir_all(out).map_err(said)?;
    for (name, bytes) in files {
        std::fs::write(out.join(name), bytes).map_err(said)?;
        println!("{} ({} kB)", out.join(name).display(), bytes.len() / 1000);
    }
    let mut names: Vec<&String> = files.iter().map(|(name, _)| name).collect();
    names.sort();
    let sums = Command::new("sha256sum")
        .args(names)
        .current_dir(out)
        .output()
        .map_err(|error| format!("sha256sum does not start: {error}"))?;
    std::fs::write(out.join("SHA256SUMS"), sums.stdout).map_err(said)
}
