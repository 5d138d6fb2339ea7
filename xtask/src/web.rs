//! `cargo xtask web`: the playground as one file, for any web host or none.

use std::path::{Path, PathBuf};
use std::process::Command;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::error::Error;
use crate::paths::{absolute, without_paths};

const TARGET: &str = "wasm32-unknown-unknown";

/// Builds the kernel for the browser, unless it is given with `--wasm FILE`, and writes
/// `target/web/index.html`, or the file after `--out`.
pub fn run(arguments: &[String]) -> Result<bool, Error> {
    let (mut wasm, mut out) = (None, PathBuf::from("target/web/index.html"));
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        let mut value = || {
            rest.next().ok_or_else(|| Error::NoValue {
                option: argument.clone(),
                value: "a file",
            })
        };
        match argument.as_str() {
            "--wasm" => wasm = Some(PathBuf::from(value()?)),
            "--out" => out = PathBuf::from(value()?),
            other => {
                return Err(Error::UnknownOption {
                    option: other.to_owned(),
                    allowed: "--wasm FILE and --out FILE",
                });
            }
        }
    }
    let wasm = match wasm {
        Some(file) => std::fs::read(&file).map_err(Error::file(&file))?,
        None => build(&absolute(Path::new("target/web"))?)?,
    };
    let page = page(&wasm);
    if let Some(folder) = out.parent() {
        std::fs::create_dir_all(folder).map_err(Error::file(folder))?;
    }
    let unfinished = out.with_extension("part");
    std::fs::write(&unfinished, &page).map_err(Error::file(&unfinished))?;
    std::fs::rename(&unfinished, &out).map_err(Error::file(&out))?;
    println!("{} ({} kB)", out.display(), page.len() / 1000);
    Ok(true)
}

/// The page with this kernel inside.
pub fn page(wasm: &[u8]) -> String {
    jcas_web::page::whole(&STANDARD.encode(wasm))
}

/// Builds the kernel for the browser in this folder, an absolute path, and returns it.
pub fn build(folder: &Path) -> Result<Vec<u8>, Error> {
    require_target()?;
    let flags = without_paths(folder)?.join("\u{1f}");
    // The size of the file matters here, and even this build runs a hundred UAVs well within a
    // frame.
    let built = Command::new("cargo")
        .args([
            "build",
            "--release",
            "--lib",
            "--package",
            "jcas-web",
            "--target",
            TARGET,
        ])
        .arg("--target-dir")
        .arg(folder)
        .env("CARGO_ENCODED_RUSTFLAGS", flags)
        .args(["--config", "profile.release.lto=\"fat\""])
        .args(["--config", "profile.release.codegen-units=1"])
        .status()
        .map_err(Error::start("cargo"))?;
    if built.success() {
        let file = folder.join(TARGET).join("release/jcas_web.wasm");
        std::fs::read(&file).map_err(Error::file(&file))
    } else {
        Err(Error::KernelBuild(TARGET))
    }
}

/// Refuses to build where the target's standard library is absent, with the command that adds it.
fn require_target() -> Result<(), Error> {
    let found = Command::new("rustc")
        .args(["--print", "target-libdir", "--target", TARGET])
        .output()
        .map_err(Error::start("rustc"))?;
    let folder = String::from_utf8_lossy(&found.stdout);
    if Path::new(folder.trim()).is_dir() {
        return Ok(());
    }
    Err(Error::NoTargetLibrary(TARGET))
}
