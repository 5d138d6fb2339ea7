//! `cargo xtask dist`: what users without Rust install, for all platforms that are served.
//!
//! The same commit gives the same files. It needs cargo-zigbuild and Zig for Linux, and mingw-w64
//! for Windows; `.ci/dist.sh` installs them.

mod archive;
mod build;
mod dependencies;
mod node;
mod package;
mod sbom;
mod targets;
mod wheels;

use std::path::PathBuf;
use std::process::Command;

use archive::{Content, Tree};
use targets::{System, TARGETS, Target};

use crate::error::Error;
use crate::{fmu, web};

const VERSION: &str = env!("CARGO_PKG_VERSION");

struct Options {
    targets: Vec<&'static Target>,
    /// Whether the playground and the package for Node.js are written.
    web: bool,
    out: PathBuf,
}

/// Writes all that is served, for all platforms or for those after `--target`, into `dist`, or the
/// folder after `--out`.
pub fn run(arguments: &[String]) -> Result<bool, Error> {
    let options = parse(arguments)?;
    let epoch = epoch()?;
    let mut out = Served::create(options.out)?;
    let graph = dependencies::graph(&options.targets)?;
    let mut units = Vec::new();
    for target in &options.targets {
        let built = build::build(target, epoch)?;
        let mut tree = package::tree(target, &built)?;
        // Of this platform alone, so that the archive does not depend on the others that are built.
        let notices = dependencies::notices(&dependencies::graph(&[*target])?)?;
        let path = "share/licenses/jcas/THIRD-PARTY".to_owned();
        tree.insert(path, Content::file(notices));
        let (name, bytes) = packed(target, &tree, epoch)?;
        out.add(name, &bytes)?;
        out.made(wheels::wheel(target, &built, &out.path, epoch)?);
        units.push(package::unit_binary(target, &built)?);
    }
    out.made(wheels::sdist(&out.path, epoch)?);
    let unit = fmu::pack(&units).map_err(Error::Unit)?;
    out.add(format!("jcas-{VERSION}.fmu"), &unit)?;
    if options.web {
        let wasm = web::build(&build::folder()?)?;
        out.add(
            format!("jcas-{VERSION}-playground.html"),
            web::page(&wasm).as_bytes(),
        )?;
        let notices = dependencies::notices(&graph)?;
        let (name, bytes) = node::package(wasm, &notices, epoch).map_err(Error::Node)?;
        out.add(name, &bytes)?;
    }
    let bill = sbom::cyclonedx(&graph, VERSION);
    out.add(format!("jcas-{VERSION}.cdx.json"), bill.as_bytes())?;
    out.checksums()?;
    Ok(true)
}

/// The platform's archive, with its name.
fn packed(target: &Target, tree: &Tree, epoch: u32) -> Result<(String, Vec<u8>), Error> {
    let root = format!("jcas-{VERSION}-{}", target.name);
    let (name, bytes) = match target.system {
        System::Linux => (
            format!("{root}.tar.gz"),
            archive::tar_gz(&root, tree, epoch).map_err(|error| Error::Archive(error.into())),
        ),
        System::Windows => (
            format!("{root}.zip"),
            archive::zip(&root, tree).map_err(Error::Archive),
        ),
    };
    Ok((name, bytes?))
}

fn parse(arguments: &[String]) -> Result<Options, Error> {
    let mut options = Options {
        targets: Vec::new(),
        web: false,
        out: PathBuf::from("dist"),
    };
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        let mut value = || {
            rest.next().ok_or_else(|| Error::NoValue {
                option: argument.clone(),
                value: "a value",
            })
        };
        match argument.as_str() {
            "--target" => options.targets.push(Target::find(value()?)?),
            "--out" => options.out = PathBuf::from(value()?),
            other => {
                return Err(Error::UnknownOption {
                    option: other.to_owned(),
                    allowed: "--target TRIPLE and --out FOLDER",
                });
            }
        }
    }
    if options.targets.is_empty() {
        options.targets = TARGETS.iter().collect();
        options.web = true;
    }
    Ok(options)
}

/// The time of the last commit, or `SOURCE_DATE_EPOCH`, in seconds since 1970.
fn epoch() -> Result<u32, Error> {
    let text = match std::env::var("SOURCE_DATE_EPOCH") {
        Ok(text) => text,
        Err(_) => {
            let output = Command::new("git")
                .args(["log", "-1", "--format=%ct"])
                .output()
                .map_err(Error::start("git"))?;
            String::from_utf8_lossy(&output.stdout).into_owned()
        }
    };
    text.trim().parse().map_err(|source| Error::CommitTime {
        text: text.clone(),
        source,
    })
}

/// The folder that is written, and the names of the files that this run has written there.
struct Served {
    path: PathBuf,
    names: Vec<String>,
}

impl Served {
    fn create(path: PathBuf) -> Result<Self, Error> {
        let explain = Error::file(&path);
        std::fs::create_dir_all(&path).map_err(&explain)?;
        let path = std::path::absolute(&path).map_err(&explain)?;
        let names = Vec::new();
        Ok(Self { path, names })
    }

    fn add(&mut self, name: String, bytes: &[u8]) -> Result<(), Error> {
        let path = self.path.join(&name);
        std::fs::write(&path, bytes).map_err(Error::file(&path))?;
        println!("{} ({} kB)", path.display(), bytes.len() / 1000);
        self.names.push(name);
        Ok(())
    }

    /// Notes a file that another program has written.
    fn made(&mut self, name: String) {
        self.names.push(name);
    }

    /// Writes `SHA256SUMS`, in the form that `sha256sum --check` reads.
    fn checksums(&mut self) -> Result<(), Error> {
        self.names.sort();
        let sums = Command::new("sha256sum")
            .args(&self.names)
            .current_dir(&self.path)
            .output()
            .map_err(Error::start("sha256sum"))?;
        if !sums.status.success() {
            let printed = String::from_utf8_lossy(&sums.stderr).into_owned();
            return Err(Error::Printed(printed));
        }
        self.add("SHA256SUMS".to_owned(), &sums.stdout)
    }
}
