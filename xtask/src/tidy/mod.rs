//! Checks sources, documents and commits against the project's rules of style.
//!
//! Each rule counts its findings in each crate. `xtask/tidy.toml` holds the accepted counts; a
//! count may shrink and never grow.

mod budget;
mod columns;
mod commits;
mod dead;
mod files;
mod functions;
mod prose;
mod sentences;
mod tables;
mod types;
mod words;

use budget::Budget;
use files::File;
use jcas_ledger::workspace_root;

/// A finding: one place that breaks a rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The rule's name, a key of `tidy.toml`.
    pub rule: &'static str,
    /// Path from the workspace's root.
    pub path: String,
    /// Line number from 1; 0 for a file as a whole.
    pub line: usize,
    /// A description of the fault.
    pub what: String,
}

/// Findings of one rule, listed up to this many for each crate.
const LISTED_MAX: usize = 40;

/// Checks the workspace; `--bless` lowers the budget to the present counts. True if no count grew.
pub fn run(arguments: &[String]) -> Result<bool, String> {
    let bless = match arguments {
        [] => false,
        [flag] if flag == "--bless" => true,
        _ => return Err("usage: cargo xtask tidy [--bless]".to_owned()),
    };
    let root = workspace_root();
    let files = files::read_all(&root)?;
    let mut budget = Budget::read(&root)?;
    let mut findings = check(&files);
    findings.extend(commits::check(&root, &budget.commits_after)?);
    let counts = budget::count(&findings, &files);
    if bless {
        budget.lower(&counts)?;
        budget.write(&root)?;
    }
    let grown = budget.grown(&counts);
    for (rule, folder, count, allowed) in &grown {
        println!("{rule}: {folder} has {count}, and {allowed} are accepted:");
        let of_rule = findings.iter().filter(|finding| finding.rule == *rule);
        let here: Vec<_> = of_rule
            .filter(|finding| budget::folder_of(&finding.path, &files) == *folder)
            .collect();
        for finding in here.iter().take(LISTED_MAX) {
            println!("  {}:{}: {}", finding.path, finding.line, finding.what);
        }
        if here.len() > LISTED_MAX {
            println!("  and {} more", here.len() - LISTED_MAX);
        }
    }
    let accepted: usize = counts.values().flat_map(|folders| folders.values()).sum();
    println!(
        "tidy: {} files, {accepted} findings, {} counts grew",
        files.len(),
        grown.len()
    );
    if budget.is_lower(&counts) {
        println!("tidy: some counts shrank; `cargo xtask tidy --bless` keeps them so");
    }
    Ok(grown.is_empty())
}

/// The findings of all rules that read files.
fn check(files: &[File]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in files {
        findings.extend(columns::check(file));
        findings.extend(functions::check(file));
        findings.extend(words::check(file));
        findings.extend(sentences::check(file));
        findings.extend(tables::check(file));
    }
    findings.extend(dead::check(files));
    findings.extend(types::check(files));
    findings
}
