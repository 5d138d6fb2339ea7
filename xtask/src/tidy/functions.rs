//! Rust functions of at most 70 lines.

use super::Finding;
use super::files::{File, Language};

const LINES_MAX: usize = 70;

/// Finds functions that are too long. A function ends at the first closing brace in the column of
/// its first word.
pub fn check(file: &File) -> Vec<Finding> {
    if file.language != Language::Rust {
        return Vec::new();
    }
    let lines: Vec<&str> = file.text.lines().collect();
    let mut findings = Vec::new();
    for (begin, line) in lines.iter().enumerate() {
        let Some(name) = function_name(line) else {
            continue;
        };
        let indent = line.len() - line.trim_start().len();
        let end = format!("{}}}", " ".repeat(indent));
        let declaration = format!("{};", " ".repeat(indent));
        let length = lines[begin..]
            .iter()
            .position(|line| *line == end || line.starts_with(&declaration))
            .map_or(0, |last| last + 1);
        // A function without a body ends in a semicolon before any brace.
        let has_body = lines[begin..begin + length]
            .iter()
            .any(|line| line.ends_with('{'));
        if has_body && length > LINES_MAX {
            findings.push(Finding {
                rule: "functions",
                path: file.path.clone(),
                line: begin + 1,
                what: format!("`{name}` has {length} lines, at most {LINES_MAX}"),
            });
        }
    }
    findings
}

/// The name of the function whose signature begins on this line.
fn function_name(line: &str) -> Option<&str> {
    let (before, after) = line.split_once("fn ")?;
    let is_word = |word: &str| {
        word.starts_with("pub")
            || ["const", "async", "unsafe", "extern", "\"C\"", "default"].contains(&word)
    };
    if !before.split_whitespace().all(is_word) {
        return None;
    }
    // A function without a body, as in a trait, ends on its line.
    if line.ends_with(';') {
        return None;
    }
    after.split(['(', '<']).next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_function_is_found() {
        let function = |lines: usize| {
            format!(
                "    pub fn f(a: u8) {{\n{}    }}\n",
                "        a;\n".repeat(lines - 2)
            )
        };
        let text = format!("impl A {{\n{}{}}}\n", function(70), function(71));
        let found = check(&File::new("core/src/a.rs", &text));
        assert_eq!(found.len(), 1);
        assert_eq!(
            (found[0].line, found[0].what.as_str()),
            (72, "`f` has 71 lines, at most 70")
        );
    }
}
