//! The text files that git tracks or would track.

use std::path::Path;
use std::process::Command;

/// One text file.
#[derive(Clone, Debug)]
pub struct File {
    /// Path from the workspace's root, with `/`.
    pub path: String,
    pub text: String,
    pub language: Language,
}

/// The language of a file, which fixes its comments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    Rust,
    /// C, C++ and JavaScript.
    Braces,
    Python,
    /// Shell, TOML, YAML and CMake.
    Hashes,
    Markdown,
    /// Other text, which is only searched for the names of files.
    Other,
}

/// Generated files; their sources are checked instead.
const GENERATED: [&str; 9] = [
    "include/jcas.h",
    "include/jcas_dl.h",
    "verification/PROOFS.md",
    "verification/RESULTS.md",
    "verification/results.toml",
    "xtask/tidy.toml",
    "docs/results.md",
    "lab/results/results.md",
    "python/src/jcas/_abi.py",
];

impl File {
    pub fn new(path: &str, text: &str) -> Self {
        let suffix = path.rsplit('.').next().unwrap_or("");
        let language = match suffix {
            _ if GENERATED.contains(&path) => Language::Other,
            "rs" => Language::Rust,
            "c" | "cc" | "cpp" | "h" | "hpp" | "js" | "mjs" => Language::Braces,
            "py" => Language::Python,
            "sh" | "toml" | "yml" | "cmake" => Language::Hashes,
            "md" => Language::Markdown,
            _ => Language::Other,
        };
        File {
            path: path.to_owned(),
            text: text.to_owned(),
            language,
        }
    }
}

/// The path of code that others wrote, which keeps their style.
const OF_OTHERS: &str = ":(exclude)site/assets";

/// Every file that git does not ignore and that is text.
pub fn read_all(root: &Path) -> Result<Vec<File>, String> {
    let listed = Command::new("git")
        .current_dir(root)
        .args([
            "ls-files",
            "-z",
            "--cached",
            "--others",
            "--exclude-standard",
            "--",
            ".",
            OF_OTHERS,
        ])
        .output()
        .map_err(|error| format!("cannot start git: {error}"))?;
    if !listed.status.success() {
        return Err(String::from_utf8_lossy(&listed.stderr).into_owned());
    }
    let mut files = Vec::new();
    for path in String::from_utf8_lossy(&listed.stdout).split_terminator('\0') {
        // A file that git lists may already be deleted. A file that is not UTF-8 has a name and no
        // text.
        let Ok(bytes) = std::fs::read(root.join(path)) else {
            continue;
        };
        files.push(File::new(
            path,
            &String::from_utf8(bytes).unwrap_or_default(),
        ));
    }
    Ok(files)
}
