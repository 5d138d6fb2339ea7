//! Fingerprints of the sources that a checked program was made of.

use crate::{Ledger, LedgerError, read};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The Rust files that harnesses depend on, by their paths from the workspace's root.
pub struct Sources(BTreeMap<String, String>);

impl Sources {
    /// Reads the files of a ledger's sources below `root`.
    pub fn read(root: &Path, ledger: &Ledger) -> Result<Self, LedgerError> {
        let mut paths = Vec::new();
        for source in &ledger.sources {
            collect(&root.join(source), &mut paths)?;
        }
        let mut files = BTreeMap::new();
        for path in paths {
            let name = path.strip_prefix(root).unwrap_or(&path).to_string_lossy();
            files.insert(name.into_owned(), read(&path)?);
        }
        Ok(Self(files))
    }

    /// Whether it holds the file.
    pub fn has(&self, path: &str) -> bool {
        self.0.contains_key(path)
    }

    /// A 64-bit FNV-1a hash, in hexadecimal, of the files of a program and of the modules that
    /// these import; none where a file is gone.
    ///
    /// A program contains its functions. Its constants and types may be those of other modules.
    /// Comments on lines of their own, blank lines and indentation do not count: no proof depends
    /// on them.
    pub fn fingerprint(&self, program: &[String]) -> Option<String> {
        let (mut imported, mut proofs) = (BTreeSet::new(), BTreeSet::new());
        for path in program {
            for declaration in imports(self.0.get(path)?) {
                let words = words(declaration);
                let names_proofs = is_proof(path) && declaration.starts_with("super::")
                    || words.contains("proofs");
                let modules = if names_proofs {
                    &mut proofs
                } else {
                    &mut imported
                };
                modules.extend(words);
            }
        }
        let mut hash = Fnv1a(0xcbf2_9ce4_8422_2325);
        for (path, text) in &self.0 {
            // A module of proofs has the name of what it proves: `crate::lanes` is not its path.
            let modules = if is_proof(path) { &proofs } else { &imported };
            if program.contains(path) || modules.contains(module(path)) {
                hash.write(path.as_bytes());
                for line in lines(text) {
                    hash.write(line.as_bytes());
                }
            }
        }
        Some(format!("{:016x}", hash.0))
    }
}

/// The lines that count.
fn lines(text: &str) -> impl Iterator<Item = &str> {
    let lines = text.lines().map(str::trim);
    lines.filter(|line| !line.is_empty() && !line.starts_with("//"))
}

/// The name of a file's module.
fn module(path: &str) -> &str {
    let path = path.trim_end_matches(".rs").trim_end_matches("/mod");
    path.rsplit('/').next().unwrap_or(path)
}

/// Whether a file is one of harnesses.
fn is_proof(path: &str) -> bool {
    path.contains("/proofs/")
}

const fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// The words of a declaration.
fn words(declaration: &str) -> BTreeSet<&str> {
    declaration.split(|c| !is_word(c)).collect()
}

/// A text's `use` declarations and its paths from the crate's root.
fn imports(text: &str) -> Vec<&str> {
    let text = text.split("#[cfg(test)]\nmod ").next().unwrap_or(text);
    let uses = text.split("use ").skip(1);
    let uses = uses.map(|part| part.split(';').next().unwrap_or(part));
    let paths = text.split("crate::").skip(1);
    let paths = paths.filter_map(|part| part.split(|c| !is_word(c) && c != ':').next());
    uses.chain(paths).collect()
}

/// Adds the Rust files at or below a path.
fn collect(path: &Path, files: &mut Vec<PathBuf>) -> Result<(), LedgerError> {
    let explain = LedgerError::file(path);
    if std::fs::metadata(path).map_err(&explain)?.is_file() {
        files.push(path.to_owned());
        return Ok(());
    }
    for entry in std::fs::read_dir(path).map_err(&explain)? {
        let inner = entry.map_err(&explain)?.path();
        if inner.is_dir() || inner.extension().is_some_and(|suffix| suffix == "rs") {
            collect(&inner, files)?;
        }
    }
    Ok(())
}

struct Fnv1a(u64);

impl Fnv1a {
    /// Adds the bytes and an end mark, so that two texts never run into each other.
    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes.iter().chain(&[0]) {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENERGY: &str = "use crate::config::{Capacity, limits::MOST};\nfn settle() {}\n";

    fn hash_with(changed: &str, text: &str) -> Option<String> {
        let mut files = BTreeMap::from([
            ("src/energy.rs".to_owned(), ENERGY.to_owned()),
            (
                "src/config/mod.rs".to_owned(),
                "struct Capacity;\n".to_owned(),
            ),
            (
                "src/config/limits.rs".to_owned(),
                "const MOST: u8 = 1;\n".to_owned(),
            ),
            (
                "src/observation.rs".to_owned(),
                "fn observe() {}\n".to_owned(),
            ),
        ]);
        files.insert(changed.to_owned(), text.to_owned());
        Sources(files).fingerprint(&["src/energy.rs".to_owned()])
    }

    /// Catches a change of a proof that makes the verdicts of its neighbours old, or not its own.
    #[test]
    fn a_proof_counts_where_it_is_named() {
        let hash_with = |lanes: &str, inputs: &str| {
            let fleet = "use super::inputs::between;\nuse crate::lanes::Block;\nfn f() {}\n";
            let files = [
                ("src/proofs/fleet.rs", fleet),
                ("src/proofs/lanes.rs", lanes),
                ("src/proofs/inputs.rs", inputs),
                ("src/lanes.rs", "struct Block;\n"),
            ];
            let files = files.map(|(path, text)| (path.to_owned(), text.to_owned()));
            Sources(files.into()).fingerprint(&["src/proofs/fleet.rs".to_owned()])
        };
        let now = hash_with("fn l() {}", "fn between() {}");
        assert_eq!(hash_with("fn other() {}", "fn between() {}"), now);
        assert_ne!(hash_with("fn l() {}", "fn other() {}"), now);
    }

    /// Catches a change of code that goes unseen, and one elsewhere that makes a verdict old.
    #[test]
    fn what_the_program_contains_and_imports_counts() {
        let now = hash_with("src/energy.rs", ENERGY);
        let commented = format!("// Why.\n\n  {ENERGY}    // Because.\n");
        assert_eq!(hash_with("src/energy.rs", &commented), now);
        assert_eq!(hash_with("src/observation.rs", "fn other() {}\n"), now);
        for (path, text) in [
            (
                "src/energy.rs",
                "use crate::config::{Capacity, limits::MOST};\nfn s() {}\n",
            ),
            ("src/config/mod.rs", "struct Capacity(u8);\n"),
            ("src/config/limits.rs", "const MOST: u8 = 2;\n"),
        ] {
            assert_ne!(hash_with(path, text), now, "{path}");
        }
    }

    #[test]
    fn a_program_whose_file_is_gone_has_no_fingerprint() {
        let sources = Sources(BTreeMap::new());
        assert_eq!(sources.fingerprint(&["src/energy.rs".to_owned()]), None);
    }

    /// Catches a folder that is not read, or read beside Rust files.
    #[test]
    fn the_workspaces_sources_are_found() {
        let ledger = Ledger::read().unwrap();
        let sources = Sources::read(&crate::workspace_root(), &ledger).unwrap();
        assert!(sources.has("core/src/proofs/energy.rs") && sources.has("ffi/src/memory.rs"));
        assert!(sources.0.keys().all(|path| path.ends_with(".rs")));
        let missing = Ledger {
            sources: vec!["no/such/folder".into()],
            proof: Vec::new(),
        };
        let error = Sources::read(Path::new("/"), &missing).err().unwrap();
        assert!(error.to_string().contains("no/such/folder"), "{error}");
    }
}
