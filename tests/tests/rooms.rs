//! The order of the kernel's rooms: a module of `core/src` uses those above it in `lib.rs` alone.

use std::fs;
use std::path::{Path, PathBuf};

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The modules that a source names by paths from the root, its tests and comments apart.
fn used(text: &str) -> impl Iterator<Item = &str> {
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or(text);
    let lines = code
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"));
    lines.flat_map(|line| {
        let names = line.split("crate::").skip(1);
        names.map(|rest| rest.split(|c: char| !c.is_alphanumeric()).next().unwrap())
    })
}

#[test]
fn each_room_of_the_kernel_uses_those_above_it_alone() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/src");
    let lib = fs::read_to_string(root.join("lib.rs")).unwrap();
    let modules = lib.lines().filter_map(|line| {
        let line = line.strip_prefix("pub ").unwrap_or(line);
        line.strip_prefix("mod ")?.strip_suffix(';')
    });
    let order: Vec<&str> = modules.filter(|&module| module != "proofs").collect();
    let place = |name: &str| order.iter().position(|&module| module == name);
    let mut files = Vec::new();
    sources(&root, &mut files);
    let mut uses = 0;
    for file in files {
        let inside = file.strip_prefix(&root).unwrap();
        let first = inside
            .components()
            .next()
            .unwrap()
            .as_os_str()
            .to_str()
            .unwrap();
        let Some(own) = place(first.trim_end_matches(".rs")) else {
            continue;
        };
        for name in used(&fs::read_to_string(&file).unwrap()) {
            if let Some(other) = place(name) {
                assert!(
                    other <= own,
                    "{} uses {name}, a room below its own",
                    inside.display()
                );
                uses += 1;
            }
        }
    }
    assert!(uses > 100, "{uses} uses were found of {order:?}");
}
