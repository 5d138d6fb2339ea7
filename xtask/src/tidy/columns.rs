//! Lines of at most 100 columns.

use super::Finding;
use super::files::{File, Language};

const COLUMNS_MAX: usize = 100;

/// Finds lines that are too long; tables and addresses cannot be broken.
pub fn check(file: &File) -> Vec<Finding> {
    if file.language == Language::Other {
        return Vec::new();
    }
    let mut findings = Vec::new();
    for (index, line) in file.text.lines().enumerate() {
        let columns = line.chars().count();
        let unbreakable = line.trim_start().starts_with('|') && file.language == Language::Markdown
            || line.contains("://");
        if columns > COLUMNS_MAX && !unbreakable {
            findings.push(Finding {
                rule: "columns",
                path: file.path.clone(),
                line: index + 1,
                what: format!("{columns} columns, at most {COLUMNS_MAX}"),
            });
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_is_found() {
        let text = format!("fine\n// {}\n", "é".repeat(98));
        let found = check(&File::new("core/src/a.rs", &text));
        assert_eq!(found.len(), 1);
        assert_eq!(
            (found[0].line, found[0].what.as_str()),
            (2, "101 columns, at most 100")
        );
        assert!(check(&File::new("a.md", &format!("| {} |", "x".repeat(200)))).is_empty());
    }
}
