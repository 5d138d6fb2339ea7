//! The packages whose code is in the binaries, as Cargo resolves them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use serde::Deserialize;

use super::targets::Target;
use crate::error::Error;

/// The packages that are built for users.
const SERVED: [&str; 3] = ["jcas-ffi", "jcas-fmi", "jcas-cli"];

#[derive(Clone, Debug, Deserialize, PartialEq, Eq, PartialOrd, Ord)]
pub struct CargoPackage {
    pub name: String,
    pub version: String,
    /// An SPDX expression.
    pub license: Option<String>,
    /// The registry, or nothing for a package of this repository.
    pub source: Option<String>,
    pub id: String,
    manifest_path: PathBuf,
}

/// What `cargo metadata` writes, as far as it is read here.
#[derive(Deserialize)]
struct CargoMetadata {
    packages: Vec<CargoPackage>,
    resolve: Resolve,
}

#[derive(Deserialize)]
struct Resolve {
    nodes: Vec<ResolvedPackage>,
}

#[derive(Deserialize)]
struct ResolvedPackage {
    id: String,
    deps: Vec<Dependency>,
}

#[derive(Deserialize)]
struct Dependency {
    pkg: String,
    dep_kinds: Vec<DependencyKind>,
}

/// `kind` is nothing for a normal dependency, and otherwise "dev" or "build".
#[derive(Deserialize)]
struct DependencyKind {
    kind: Option<String>,
}

/// The packages in the binaries of these platforms, with the identifiers of what each depends on.
pub type Graph = BTreeMap<CargoPackage, BTreeSet<String>>;

/// Reads the graph of all targets. Features are those of the whole workspace.
pub fn graph(targets: &[&Target]) -> Result<Graph, Error> {
    let mut graph = Graph::new();
    for target in targets {
        let output = Command::new("cargo")
            .args(["metadata", "--locked", "--format-version", "1"])
            .args(["--filter-platform", target.triple])
            .output()
            .map_err(Error::start("cargo"))?;
        let metadata: CargoMetadata = serde_json::from_slice(&output.stdout).map_err(|source| {
            let printed = String::from_utf8_lossy(&output.stderr).into_owned();
            Error::Metadata { source, printed }
        })?;
        for (package, depends_on) in reachable(&metadata) {
            graph.entry(package).or_default().extend(depends_on);
        }
    }
    Ok(graph)
}

/// The packages that normal dependencies lead to from those that are served.
fn reachable(metadata: &CargoMetadata) -> Graph {
    let packages = &metadata.packages;
    let mut waiting: Vec<&str> = packages
        .iter()
        .filter(|package| SERVED.contains(&package.name.as_str()))
        .map(|package| package.id.as_str())
        .collect();
    let mut graph = Graph::new();
    let mut seen: BTreeSet<&str> = waiting.iter().copied().collect();
    while let Some(id) = waiting.pop() {
        let package = packages.iter().find(|package| package.id == id);
        let node = metadata.resolve.nodes.iter().find(|node| node.id == id);
        let (Some(package), Some(node)) = (package, node) else {
            continue;
        };
        let normal = node.deps.iter().filter(|dependency| {
            let mut kinds = dependency.dep_kinds.iter();
            kinds.any(|kind| kind.kind.is_none())
        });
        let depends_on: BTreeSet<&str> = normal.map(|dependency| dependency.pkg.as_str()).collect();
        waiting.extend(depends_on.iter().filter(|id| seen.insert(id)));
        let depends_on = depends_on.into_iter().map(str::to_owned).collect();
        graph.insert(package.clone(), depends_on);
    }
    graph
}

/// The licence texts of the packages from elsewhere, one after the other, and of the font that
/// figures embed.
pub fn notices(graph: &Graph) -> Result<String, Error> {
    let mut text = "The binaries contain the packages below, each under its own license, and the\n\
                    standard library of Rust (https://www.rust-lang.org, MIT OR Apache-2.0).\n"
        .to_owned();
    let rule = "=".repeat(80);
    for package in graph.keys() {
        let folder = package.manifest_path.parent().unwrap_or(Path::new("."));
        let folder = if package.source.is_some() {
            let license = package.license.as_deref().unwrap_or("see below");
            let (name, version) = (&package.name, &package.version);
            text += &format!("\n{rule}\n{name} {version}: {license}\n");
            folder.to_owned()
        } else if package.name == "jcas-figures" {
            text += &format!("\n{rule}\nThe font Roboto, (C) 2011 Google Inc.: Apache-2.0\n");
            folder.join("src/font")
        } else {
            continue;
        };
        for file in license_files(&folder)? {
            let license = std::fs::read_to_string(&file).map_err(Error::file(&file))?;
            text += &format!("\n{}\n", license.trim_end());
        }
    }
    Ok(text)
}

fn license_files(folder: &Path) -> Result<BTreeSet<PathBuf>, Error> {
    let explain = Error::file(folder);
    let mut files = BTreeSet::new();
    for entry in std::fs::read_dir(folder).map_err(&explain)? {
        let path = entry.map_err(&explain)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.to_uppercase();
        let starts = ["LICENSE", "LICENCE", "COPYING", "NOTICE"];
        if path.is_file() && starts.iter().any(|start| name.starts_with(start)) {
            files.insert(path);
        }
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The command links clap, the kernel libm; cbindgen and proptest serve builds and tests only.
    #[test]
    fn the_graph_has_what_is_linked_and_nothing_of_tests() {
        let linux = Target::find("x86_64-unknown-linux-gnu").unwrap();
        let graph = graph(&[linux]).unwrap();
        let has = |name: &str| graph.keys().any(|package| package.name == name);
        assert!(has("clap") && has("libm") && has("jcas-core"));
        assert!(!has("cbindgen") && !has("proptest") && !has("windows-sys"));
        let text = notices(&graph).unwrap();
        assert!(text.contains("libm 0.2.16: MIT") && !text.contains("jcas-core"));
        let (_, font) = text.split_once("The font Roboto").unwrap();
        assert!(font.contains("Apache License"));
    }
}
