//! Files that no other file names.

use super::File;

/// Documents that a reader finds by their names, and files that a tool finds by theirs.
const FOUND_BY_NAME: &str = "README CHANGELOG CONTRIBUTING SECURITY ARCHITECTURE lib main mod \
                             build conftest setup __init__ __main__ _version";

/// Suffixes of files that another file has to name.
const NAMED: &str = "rs md sh py c cc cpp js mjs png svg webp css";

/// Folders whose Rust files Cargo builds because they lie there.
const TARGETS: &str = "tests examples benches bin";

/// Finds Rust modules that no file declares, and other files that no file mentions.
pub fn check(files: &[File]) -> Vec<String> {
    let is_one_of = |word: &str, list: &str| list.split(' ').any(|listed| listed == word);
    let is_dead = |file: &&File| {
        let (folder, name) = file.path.rsplit_once('/').unwrap_or(("", &file.path));
        let (stem, suffix) = name.split_once('.').unwrap_or((name, ""));
        let last = folder.rsplit('/').next().unwrap_or("");
        // Others import a module, or run a program, without its suffix.
        let word = match suffix {
            "rs" => format!("mod {stem}"),
            "md" | "png" | "svg" | "webp" | "css" => name.to_owned(),
            _ => stem.to_owned(),
        };
        let names = |other: &File| other.text.contains(name) || has_word(&other.text, &word);
        let found_by_name = is_one_of(stem, FOUND_BY_NAME) || stem.starts_with("test_");
        let target = suffix == "rs" && is_one_of(last, TARGETS);
        let named = |other: &File| other.path != file.path && names(other);
        is_one_of(suffix, NAMED) && !found_by_name && !target && !files.iter().any(named)
    };
    let dead = files.iter().filter(is_dead);
    dead.map(|file| format!("{}: no other file names it", file.path))
        .collect()
}

/// Whether the text contains the word as a whole word.
fn has_word(text: &str, word: &str) -> bool {
    let inner = |c: char| c.is_alphanumeric() || c == '_';
    let ends = |text: &str, rest: &str| !text.ends_with(inner) && !rest.starts_with(inner);
    text.match_indices(word)
        .any(|(at, _)| ends(&text[..at], &text[at + word.len()..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_nothing_names_are_found() {
        let files = [
            ("src/lib.rs", "mod used;"),
            ("src/used.rs", ""),
            ("src/unused.rs", "mod unused_too;"),
            ("core/tests/target.rs", ""),
            ("docs/linked.md", ""),
            ("docs/alone.md", "See alone.md."),
            ("README.md", "[linked](docs/linked.md)"),
            (".ci/lint.sh", ""),
            (".ci/stray.sh", ""),
            (".ci/run", "lint        astray"),
        ];
        let file = |(path, text): (&str, &str)| File {
            path: path.into(),
            text: text.into(),
        };
        let found = check(&files.map(file));
        let dead = ["src/unused.rs", "docs/alone.md", ".ci/stray.sh"];
        assert_eq!(
            found,
            dead.map(|path| format!("{path}: no other file names it"))
        );
    }
}
