//! `cargo xtask web`: the playground as one file, for any web host or none.

use std::path::{Path, PathBuf};
use std::process::Command;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::paths::{absolute, without_paths};

const TARGET: &str = "wasm32-unknown-unknown";

/// Builds the kernel for the browser, unless it is given with `--wasm FILE`, and writes
/// `target/web/index.html`, or the file after `--out`.
pub fn run(arguments: &[String]) -> Result<bool, String> {
    let (mut wasm, mut out) = (None, PathBuf::from("target/web/index.html"));
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        let mut value = || {
            rest.next()
                .ok_or(format!("{argument} needs a file after it"))
        };
        match argument.as_str() {
            "--wasm" => wasm = Some(PathBuf::from(value()?)),
            "--out" => out = PathBuf::from(value()?),
            other => return Err(format!("{other}: there are --wasm FILE and --out FILE")),
        }
    }
    let wasm = match wasm {
        Some(file) => std::fs::read(&file).map_err(said(&file))?,
        None => build(&absolute(Path::new("target/web"))?)?,
    };
    let page = page(&wasm);
    if let Some(folder) = out.parent() {
        std::fs::create_dir_all(folder).map_err(said(folder))?;
    }
    let unfinished = out.with_extension("part");
    std::fs::write(&unfinished, &page).map_err(said(&unfinished))?;
    std::fs::rename(&unfinished, &out).map_err(said(&out))?;
    println!("{} ({} kB)", out.display(), page.len() / 1000);
    Ok(true)
}

/// The page with this kernel inside.
pub fn page(wasm: &[u8]) -> String {
    jcas_web::page::whole(&STANDARD.encode(wasm))
}

/// Builds the kernel for the browser in this folder, an absolute path, and returns it.
pub fn build(folder: &Path) -> Result<Vec<u8>, String> {
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
        .map_err(|error| format!("cargo does not start: {error}"))?;
    if built.success() {
        let file = folder.join(TARGET).join("release/jcas_web.wasm");
        std::fs::read(&file).map_err(said(&file))
    } else {
        Err(format!("the kernel does not build for {TARGET}"))
    }
}

/// Refuses to build where the target's standard library is absent, with the command that adds it.
fn require_target() -> Result<(), String> {
    let found = Command::new("rustc")
        .args(["--print", "target-libdir", "--target", TARGET])
        .output()
        .map_err(|error| format!("rustc does not start: {error}"))?;
    let folder = String::from_utf8_lossy(&found.stdout);
    if Path::new(folder.trim()).is_dir() {
        return Ok(());
    }
    Err(format!(
        "the library of {TARGET} is absent: `rustup target add {TARGET}` installs it"
    ))
}

fn said(path: &Path) -> impl FnOnce(std::io::Error) -> String {
    let path = path.display().to_string();
    move |error| format!("{path}: {error}")
}
