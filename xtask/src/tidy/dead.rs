//! Files that no other file names.

use super::Finding;
use super::files::{File, Language};

/// Documents that a reader finds by their names, and files that a tool finds by theirs.
const FOUND_BY_NAME: [&str; 14] = [
    "README",
    "CHANGELOG",
    "CONTRIBUTING",
    "SECURITY",
    "ARCHITECTURE",
    "lib",
    "main",
    "mod",
    "build",
    "conftest",
    "setup",
    "__init__",
    "__main__",
    "_version",
];

/// Suffixes of files that another file has to name.
const NAMED: [&str; 13] = [
    "rs", "md", "sh", "py", "c", "cc", "cpp", "js", "mjs", "png", "svg", "webp", "css",
];

/// Finds Rust modules that no `mod` declares, and other files that no file mentions.
pub fn check(files: &[File]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in files {
        let (folder, name) = file.path.rsplit_once('/').unwrap_or(("", &file.path));
        let Some((stem, suffix)) = name.rsplit_once('.') else {
            continue;
        };
        if !NAMED.contains(&suffix) || FOUND_BY_NAME.contains(&stem) {
            continue;
        }
        let is_alive = match file.language {
            Language::Rust => is_target(&file.path) || is_declared(file, stem, files),
            _ if stem.starts_with("test_") => true,
            _ => is_mentioned(file, folder, name, files),
        };
        if !is_alive {
            findings.push(Finding {
                rule: "dead",
                path: file.path.clone(),
                line: 0,
                what: "no other file names it".to_owned(),
            });
        }
    }
    findings
}

/// Whether Cargo builds the file because of its location.
fn is_target(path: &str) -> bool {
    let mut parts = path.rsplit('/').skip(1);
    parts
        .next()
        .is_some_and(|folder| ["tests", "examples", "benches", "bin"].contains(&folder))
}

/// Whether another Rust file of the tree declares the module or includes the file.
fn is_declared(file: &File, stem: &str, files: &[File]) -> bool {
    let top = file.path.split('/').next().unwrap_or("");
    let declared = [
        format!("mod {stem};"),
        format!("mod {stem} {{"),
        format!("{stem}.rs\""),
    ];
    let others = files.iter().filter(|other| {
        other.language == Language::Rust && other.path != file.path && other.path.starts_with(top)
    });
    others
        .into_iter()
        .any(|other| declared.iter().any(|text| other.text.contains(text)))
}

/// Whether another file contains the name, or for a program its stem.
fn is_mentioned(file: &File, folder: &str, name: &str, files: &[File]) -> bool {
    let stem = name.split('.').next().unwrap_or(name);
    let by_stem = matches!(file.language, Language::Python | Language::Braces) || folder == ".ci";
    let others = files.iter().filter(|other| other.path != file.path);
    others
        .into_iter()
        .any(|other| other.text.contains(name) || by_stem && has_word(&other.text, stem))
}

/// Whether the text contains the word as a whole word.
fn has_word(text: &str, word: &str) -> bool {
    let inner = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(word)
        .any(|(at, _)| !text[..at].ends_with(inner) && !text[at + word.len()..].starts_with(inner))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_nothing_names_are_found() {
        let files = [
            File::new("core/src/lib.rs", "mod used;\n"),
            File::new("core/src/used.rs", ""),
            File::new("core/src/unused.rs", "mod unused_too;"),
            File::new("core/tests/target.rs", ""),
            File::new("docs/linked.md", ""),
            File::new("docs/alone.md", "See alone.md."),
            File::new("README.md", "[linked](docs/linked.md)\n"),
            File::new(".ci/lint.sh", ""),
            File::new(".ci/stray.sh", ""),
            File::new(".ci/run", "lint        formatting; astray\n"),
        ];
        let found: Vec<_> = check(&files)
            .into_iter()
            .map(|finding| finding.path)
            .collect();
        assert_eq!(
            found,
            ["core/src/unused.rs", "docs/alone.md", ".ci/stray.sh"]
        );
    }
}
