//! `xtask/tidy.toml`: how many findings of each rule are accepted in each crate.

use super::Finding;
use super::files::File;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Findings by rule and by crate.
pub type Counts = BTreeMap<String, BTreeMap<String, usize>>;

/// The numbers of accepted findings.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Budget {
    /// The commit after which subjects are checked.
    pub commits_after: String,
    /// Numbers of accepted findings; a missing crate has none.
    #[serde(default)]
    accepted: Counts,
}

const PATH: &str = "xtask/tidy.toml";

impl Budget {
    pub fn read(root: &Path) -> Result<Self, String> {
        let text = jcas_ledger::read(&root.join(PATH))?;
        toml::from_str(&text).map_err(|error| format!("{PATH}: {error}"))
    }

    pub fn write(&self, root: &Path) -> Result<(), String> {
        let text = toml::to_string(self).map_err(|error| error.to_string())?;
        let head = "# Findings of `cargo xtask tidy` that are accepted. Its `--bless` writes\n\
                    # them anew, and never raises the sum of a rule.\n\n";
        jcas_ledger::write(&root.join(PATH), &format!("{head}{text}"))
    }

    /// Crates with more findings of a rule than accepted: rule, crate, findings, accepted.
    pub fn grown<'a>(&self, counts: &'a Counts) -> Vec<(&'a str, &'a str, usize, usize)> {
        let mut grown = Vec::new();
        for (rule, folders) in counts {
            for (folder, count) in folders {
                let accepted = self.accepted(rule, folder);
                if *count > accepted {
                    grown.push((rule.as_str(), folder.as_str(), *count, accepted));
                }
            }
        }
        grown
    }

    /// Whether some crate has fewer findings than accepted.
    pub fn is_lower(&self, counts: &Counts) -> bool {
        self.accepted.iter().any(|(rule, folders)| {
            let count = |folder| counts.get(rule).and_then(|now| now.get(folder));
            folders
                .iter()
                .any(|(folder, accepted)| count(folder).copied().unwrap_or(0) < *accepted)
        })
    }

    /// Accepts the present counts if no rule has more findings than before. The sum of a rule
    /// decides, since a file may move from one crate to another.
    pub fn lower(&mut self, counts: &Counts) -> Result<(), String> {
        for (rule, folders) in counts {
            let now: usize = folders.values().sum();
            if let Some(accepted) = self.accepted.get(rule) {
                let before: usize = accepted.values().sum();
                if now > before {
                    return Err(format!(
                        "{rule}: {now} findings, and {before} are accepted: the budget only shrinks"
                    ));
                }
            }
        }
        self.accepted.clone_from(counts);
        Ok(())
    }

    fn accepted(&self, rule: &str, folder: &str) -> usize {
        let folders = self.accepted.get(rule);
        folders
            .and_then(|folders| folders.get(folder))
            .copied()
            .unwrap_or(0)
    }
}

/// Counts findings by rule and crate. A rule without findings has an empty entry.
pub fn count(findings: &[Finding], files: &[File]) -> Counts {
    let rules = [
        "columns",
        "commits",
        "dead",
        "functions",
        "sentences",
        "tables",
        "types",
        "words",
    ];
    let mut counts: Counts = rules.map(|rule| (rule.to_owned(), BTreeMap::new())).into();
    for finding in findings {
        let folders = counts.entry(finding.rule.to_owned()).or_default();
        *folders.entry(folder_of(&finding.path, files)).or_default() += 1;
    }
    counts
}

/// The nearest folder above a path that has a manifest, or the first folder; "." at the top.
pub fn folder_of(path: &str, files: &[File]) -> String {
    let mut folder = path;
    while let Some((above, _)) = folder.rsplit_once('/') {
        let manifest = format!("{above}/Cargo.toml");
        if files.iter().any(|file| file.path == manifest) {
            return above.to_owned();
        }
        folder = above;
    }
    match path.split_once('/') {
        Some((first, _)) => first.to_owned(),
        None => ".".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(core: usize, policy: usize) -> Counts {
        let folders = BTreeMap::from([("core".to_owned(), core), ("policy".to_owned(), policy)]);
        BTreeMap::from([("columns".to_owned(), folders)])
    }

    #[test]
    fn a_budget_shrinks_and_never_grows() {
        let mut budget = Budget {
            commits_after: String::new(),
            accepted: counts(3, 2),
        };
        assert!(budget.grown(&counts(3, 2)).is_empty());
        assert_eq!(budget.grown(&counts(4, 0)), [("columns", "core", 4, 3)]);
        assert!(budget.lower(&counts(4, 2)).is_err());
        assert!(budget.is_lower(&counts(4, 1)));
        // One finding has moved from one crate to the other.
        budget.lower(&counts(5, 0)).unwrap();
        assert!(!budget.is_lower(&counts(5, 0)));
        assert_eq!(budget.grown(&counts(5, 1)), [("columns", "policy", 1, 0)]);
    }

    #[test]
    fn a_path_belongs_to_its_crate() {
        let files = [
            File::new("lab/train/Cargo.toml", ""),
            File::new("core/Cargo.toml", ""),
        ];
        assert_eq!(folder_of("lab/train/src/ppo/a.rs", &files), "lab/train");
        assert_eq!(folder_of("core/src/a.rs", &files), "core");
        assert_eq!(folder_of("docs/a.md", &files), "docs");
        assert_eq!(folder_of("README.md", &files), ".");
    }
}
