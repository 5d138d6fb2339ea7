//! `cargo xtask fmu`: the kernel as a Functional Mock-up Unit.

use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::error::Error;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

const PAGE: &str = include_str!("../../fmi/documentation/index.html");
const LICENSES: [(&str, &str); 2] = [
    ("LICENSE-APACHE.txt", include_str!("../../LICENSE-APACHE")),
    ("LICENSE-MIT.txt", include_str!("../../LICENSE-MIT")),
];

/// Builds the unit for this machine and writes `target/fmu/jcas.fmu`, or the file after `--out`.
pub fn run(arguments: &[String]) -> Result<bool, Error> {
    let out = match arguments {
        [] => PathBuf::from("target/fmu/jcas.fmu"),
        [option, file] if option == "--out" => PathBuf::from(file),
        _ => return Err(Error::Usage("fmu takes --out FILE")),
    };
    let binary = Binary {
        platform: platform(),
        extension: extension(),
        library: build()?,
    };
    let archive = pack(&[binary]).map_err(Error::Unit)?;
    let explain = Error::file(&out);
    if let Some(folder) = out.parent() {
        std::fs::create_dir_all(folder).map_err(&explain)?;
    }
    let unfinished = out.with_extension("part");
    std::fs::write(&unfinished, &archive).map_err(&explain)?;
    std::fs::rename(&unfinished, &out).map_err(&explain)?;
    println!("{} ({} kB)", out.display(), archive.len() / 1000);
    Ok(true)
}

/// A library of the unit, under the names of the FMI standard.
pub struct Binary {
    pub platform: String,
    pub extension: &'static str,
    pub library: Vec<u8>,
}

/// The unit with the libraries of these platforms.
pub fn pack(binaries: &[Binary]) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().unix_permissions(0o644);
    let mut add = |name: &str, bytes: &[u8]| -> Result<(), Box<dyn std::error::Error>> {
        zip.start_file(name, options)?;
        Ok(zip.write_all(bytes)?)
    };
    add(
        "modelDescription.xml",
        jcas_fmi::description::xml()?.as_bytes(),
    )?;
    for binary in binaries {
        let name = format!("binaries/{}/jcas.{}", binary.platform, binary.extension);
        add(&name, &binary.library)?;
    }
    add("documentation/index.html", PAGE.as_bytes())?;
    for (name, bytes) in jcas_web::episode::SHIPPED {
        add(&format!("resources/{name}.safetensors"), bytes)?;
    }
    for (name, text) in LICENSES {
        add(&format!("documentation/licenses/{name}"), text.as_bytes())?;
    }
    Ok(zip.finish()?.into_inner())
}

/// The platform name of this machine in the FMI standard.
fn platform() -> String {
    let system = match std::env::consts::OS {
        "macos" => "darwin",
        other => other,
    };
    format!("{}-{system}", std::env::consts::ARCH)
}

/// The file name extension of a library in the FMI standard.
fn extension() -> &'static str {
    match std::env::consts::OS {
        "macos" => "dylib",
        "windows" => "dll",
        _ => "so",
    }
}

/// The bytes of the unit's library.
fn build() -> Result<Vec<u8>, Error> {
    let built = Command::new("cargo")
        .args(["build", "--release", "--lib", "--package", "jcas-fmi"])
        .status()
        .map_err(Error::start("cargo"))?;
    if !built.success() {
        return Err(Error::UnitBuild);
    }
    let target = std::env::var("CARGO_TARGET_DIR").unwrap_or_else(|_| "target".to_owned());
    let file = format!("{}jcas_fmi.{}", std::env::consts::DLL_PREFIX, extension());
    let library = Path::new(&target).join("release").join(file);
    std::fs::read(&library).map_err(Error::file(&library))
}
