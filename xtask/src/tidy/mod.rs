//! Rules of style that no other tool checks: sentences of comments and documents, and files that
//! nothing names. The section `lint` of `.ci/run` holds the other rules.

mod dead;
mod prose;

use crate::error::Error;
use jcas_ledger::workspace_root;
use std::path::Path;
use std::process::Command;

/// A text file that git tracks or would track.
pub struct File {
    /// Path from the workspace's root, with `/`.
    pub path: String,
    /// Empty where the file is not UTF-8.
    pub text: String,
}

/// Checks the workspace and prints each finding with its place. True if there is none.
pub fn run(arguments: &[String]) -> Result<bool, Error> {
    if let [argument, ..] = arguments {
        return Err(Error::TidyArgument(argument.clone()));
    }
    let root = workspace_root();
    // Git may list a file that is already deleted.
    let read = |path: String| {
        let text = String::from_utf8(std::fs::read(root.join(&path)).ok()?).unwrap_or_default();
        Some(File { path, text })
    };
    let paths = list(&root, ":(exclude,attr:linguist-vendored)")?;
    let files: Vec<File> = paths.into_iter().filter_map(read).collect();
    let by_hand = list(&root, ":(exclude,attr:linguist-generated)")?;
    let mut findings = dead::check(&files);
    let is_by_hand = |file: &&File| by_hand.contains(&file.path);
    findings.extend(files.iter().filter(is_by_hand).flat_map(prose::check));
    findings.iter().for_each(|finding| println!("{finding}"));
    println!("tidy: {} files, {} findings", files.len(), findings.len());
    Ok(findings.is_empty())
}

/// Every file that git does not ignore, narrowed by a pathspec.
fn list(root: &Path, pathspec: &str) -> Result<Vec<String>, Error> {
    let arguments = "ls-files -z --cached --others --exclude-standard -- .";
    let mut git = Command::new("git");
    git.args(arguments.split(' '))
        .arg(pathspec)
        .current_dir(root);
    let listed = git.output().map_err(Error::start("git"))?;
    if !listed.status.success() {
        let printed = String::from_utf8_lossy(&listed.stderr).into_owned();
        return Err(Error::Printed(printed));
    }
    let paths = String::from_utf8_lossy(&listed.stdout);
    Ok(paths.split_terminator('\0').map(str::to_owned).collect())
}
