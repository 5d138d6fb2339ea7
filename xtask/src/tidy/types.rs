//! Names of types that more than two crates define.

use super::Finding;
use super::budget::folder_of;
use super::files::{File, Language};
use std::collections::{BTreeMap, BTreeSet};

const CRATES_MAX: usize = 2;

/// Finds every definition of a type name that too many crates define, apart from tests.
pub fn check(files: &[File]) -> Vec<Finding> {
    let mut definitions: BTreeMap<&str, Vec<(String, &File, usize)>> = BTreeMap::new();
    for file in files {
        if file.language != Language::Rust || file.path.contains("tests/") {
            continue;
        }
        let code = file
            .text
            .split("#[cfg(test)]\nmod tests")
            .next()
            .unwrap_or("");
        for (index, line) in code.lines().enumerate() {
            if let Some(name) = defined(line) {
                let place = (folder_of(&file.path, files), file, index + 1);
                definitions.entry(name).or_default().push(place);
            }
        }
    }
    let mut findings = Vec::new();
    for (name, places) in definitions {
        let crates: BTreeSet<&str> = places.iter().map(|place| place.0.as_str()).collect();
        if crates.len() > CRATES_MAX {
            for (_, file, line) in &places {
                findings.push(Finding {
                    rule: "types",
                    path: file.path.clone(),
                    line: *line,
                    what: format!("`{name}` is defined in {} crates", crates.len()),
                });
            }
        }
    }
    findings
}

/// The name of the type that a line begins to define.
fn defined(line: &str) -> Option<&str> {
    let mut words = line.split_whitespace();
    let mut word = words.next()?;
    if word.starts_with("pub") {
        word = words.next()?;
    }
    if !["struct", "enum", "union", "trait"].contains(&word) {
        return None;
    }
    let name = words.next()?;
    name.split(|c: char| !c.is_alphanumeric() && c != '_')
        .next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_of_three_crates_is_found() {
        let manifest = |folder: &str| File::new(&format!("{folder}/Cargo.toml"), "");
        let file = |folder: &str, text: &str| File::new(&format!("{folder}/src/lib.rs"), text);
        let files = [
            manifest("a"),
            manifest("b"),
            manifest("c"),
            file("a", "pub struct Plan;\nstruct Two;\n"),
            file("b", "pub(crate) enum Plan {}\nstruct Two;\n"),
            file(
                "c",
                "struct Plan<'a>(&'a u8);\n#[cfg(test)]\nmod tests {\n    struct Two;\n}\n",
            ),
        ];
        let found = check(&files);
        assert_eq!(found.len(), 3);
        assert!(
            found
                .iter()
                .all(|finding| finding.what == "`Plan` is defined in 3 crates")
        );
    }
}
