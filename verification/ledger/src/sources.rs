//! Fingerprints of the sources that the proofs of a package depend on.

use crate::{Ledger, read};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

impl Ledger {
    /// The fingerprint of each package's sources below `root`.
    pub fn fingerprints(&self, root: &Path) -> Result<BTreeMap<String, String>, String> {
        let mut found = BTreeMap::new();
        for (package, paths) in &self.sources {
            found.insert(package.clone(), fingerprint(root, paths)?);
        }
        Ok(found)
    }
}

/// A 64-bit FNV-1a hash, in hexadecimal, of the Rust files at and below `paths`.
///
/// Comments on lines of their own, blank lines and indentation do not count: no proof depends on
/// them.
pub fn fingerprint(root: &Path, paths: &[String]) -> Result<String, String> {
    let mut files = Vec::new();
    for path in paths {
        collect(&root.join(path), &mut files)?;
    }
    files.sort();
    let mut hash = Fnv1a(0xcbf2_9ce4_8422_2325);
    for file in files {
        let name = file.strip_prefix(root).unwrap_or(&file);
        hash.write(name.to_string_lossy().as_bytes());
        for line in read(&file)?.lines().map(str::trim) {
            if !line.is_empty() && !line.starts_with("//") {
                hash.write(line.as_bytes());
            }
        }
    }
    Ok(format!("{:016x}", hash.0))
}

/// Adds the Rust files at or below a path.
fn collect(path: &Path, files: &mut Vec<PathBuf>) -> Result<(), String> {
    let explain = |error: std::io::Error| format!("{}: {error}", path.display());
    if std::fs::metadata(path).map_err(explain)?.is_file() {
        files.push(path.to_owned());
        return Ok(());
    }
    for entry in std::fs::read_dir(path).map_err(explain)? {
        let inner = entry.map_err(explain)?.path();
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

    /// A folder that is removed with the value.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("jcas-{name}-{}", std::process::id()));
            std::fs::create_dir_all(path.join("src/deep")).unwrap();
            Folder(path)
        }

        fn hash_of(&self, file: &str, text: &str) -> String {
            std::fs::write(self.0.join(file), text).unwrap();
            fingerprint(&self.0, &["src".into()]).unwrap()
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    /// Catches a change of code that goes unseen, and a comment that counts as one.
    #[test]
    fn code_counts_and_comments_do_not() {
        let folder = Folder::new("fingerprint");
        let before = folder.hash_of("src/deep/a.rs", "fn a() {\n    1 + 1;\n}\n");
        let commented = "// Why.\nfn a() {\n\n  1 + 1;\n    // Because.\n}\n";
        assert_eq!(folder.hash_of("src/deep/a.rs", commented), before);
        assert_ne!(
            folder.hash_of("src/deep/a.rs", "fn a() {\n    1 - 1;\n}\n"),
            before
        );
        assert_eq!(
            folder.hash_of("src/notes.md", "not a source"),
            folder.hash_of("src/x.md", "")
        );
        let other = folder.hash_of("src/b.rs", "fn b() {}\n");
        std::fs::rename(folder.0.join("src/b.rs"), folder.0.join("src/c.rs")).unwrap();
        assert_ne!(fingerprint(&folder.0, &["src".into()]).unwrap(), other);
    }

    #[test]
    fn a_path_that_is_gone_is_an_error() {
        let error = fingerprint(Path::new("/"), &["no/such/folder".into()]).unwrap_err();
        assert!(error.contains("no/such/folder"), "{error}");
    }
}
