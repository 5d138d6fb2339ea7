//! Subjects of commits: `area: imperative change`, at most 72 columns.

use super::Finding;
use std::path::Path;
use std::process::Command;

const COLUMNS_MAX: usize = 72;

/// Finds faults in the subjects of the commits after `after`; older commits follow no rule.
///
/// In a shallow clone without that commit, only the newest commit is checked.
pub fn check(root: &Path, after: &str) -> Result<Vec<Finding>, String> {
    let range = format!("{after}..HEAD");
    let log = git_log(root, &[&range]).or_else(|_| git_log(root, &["-1"]))?;
    let mut findings = Vec::new();
    for line in log.lines() {
        let (commit, subject) = line.split_once(' ').unwrap_or((line, ""));
        if let Some(what) = fault(subject) {
            findings.push(Finding {
                rule: "commits",
                path: commit.to_owned(),
                line: 0,
                what: format!("{what}: {subject}"),
            });
        }
    }
    Ok(findings)
}

fn git_log(root: &Path, range: &[&str]) -> Result<String, String> {
    let log = Command::new("git")
        .current_dir(root)
        .args(["log", "--no-merges", "--format=%h %s"])
        .args(range)
        .output()
        .map_err(|error| format!("cannot start git: {error}"))?;
    if log.status.success() {
        Ok(String::from_utf8_lossy(&log.stdout).into_owned())
    } else {
        Err(String::from_utf8_lossy(&log.stderr).into_owned())
    }
}

/// The faults of a subject.
fn fault(subject: &str) -> Option<&'static str> {
    if subject.chars().count() > COLUMNS_MAX {
        return Some("more than 72 columns");
    }
    let Some((area, change)) = subject.split_once(": ") else {
        return Some("no `area: `");
    };
    let is_area = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-_/., ".contains(c);
    if area.is_empty() || !area.chars().all(is_area) {
        return Some("an area in lower case stands first");
    }
    if change.ends_with('.') {
        return Some("a subject has no full stop");
    }
    let verb = change.split(' ').next().unwrap_or("");
    let past =
        verb.ends_with("ed") && !["embed", "feed", "seed", "shed", "need", "speed"].contains(&verb);
    let progressive = verb.ends_with("ing") && !["bring", "string", "ring"].contains(&verb);
    if past || progressive || ["a", "an", "the"].contains(&verb.to_lowercase().as_str()) {
        return Some("the change begins with a verb in the imperative");
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_subjects_are_found() {
        assert_eq!(fault("core: fly every fleet over one body"), None);
        assert_eq!(fault("ffi, python: refuse a NaN"), None);
        assert!(fault("What reading tours costs, measured again").is_some());
        assert!(fault(&format!("core: {}", "x".repeat(67))).is_some());
        assert!(fault("Core: change").is_some());
        assert!(fault("core: added a field").is_some());
        assert!(fault("core: adding a field").is_some());
        assert!(fault("core: the field is gone").is_some());
        assert!(fault("core: add a field.").is_some());
    }
}
