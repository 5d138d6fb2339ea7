//! Tables of numbers without the command that makes them.

use super::Finding;
use super::files::{File, Language};

/// Maximum number of lines between a table and its command.
const DISTANCE_MAX: usize = 20;

/// Number of cells with a digit that makes a table one of numbers.
const NUMBERS_MIN: usize = 4;

/// Finds tables of numbers with neither a command nor a link nearby.
pub fn check(file: &File) -> Vec<Finding> {
    if file.language != Language::Markdown {
        return Vec::new();
    }
    let lines: Vec<&str> = file.text.lines().collect();
    let mut findings = Vec::new();
    let mut begin = 0;
    while begin < lines.len() {
        let rows = lines[begin..]
            .iter()
            .take_while(|line| line.starts_with('|'))
            .count();
        if rows > 2 && numbers(&lines[begin..begin + rows]) >= NUMBERS_MIN {
            let first = begin.saturating_sub(DISTANCE_MAX);
            let last = (begin + rows + DISTANCE_MAX).min(lines.len());
            if !lines[first..last].iter().any(|line| has_source(line)) {
                findings.push(Finding {
                    rule: "tables",
                    path: file.path.clone(),
                    line: begin + 1,
                    what: "numbers without the command that makes them".to_owned(),
                });
            }
        }
        begin += rows.max(1);
    }
    findings
}

/// Cells below the heading that begin with a number.
fn numbers(rows: &[&str]) -> usize {
    let is_number = |cell: &&str| {
        let cell = cell
            .trim()
            .trim_start_matches(['*', '+', '−', '-', '~', '≈', '<', '>', ' ']);
        cell.starts_with(|c: char| c.is_ascii_digit())
    };
    rows[2..]
        .iter()
        .flat_map(|row| row.split('|').skip(2))
        .filter(is_number)
        .count()
}

/// Whether a line names a command or links to a page.
fn has_source(line: &str) -> bool {
    let commands = [
        "cargo ",
        "jcas ",
        "jcas-lab ",
        "python",
        "bash ",
        "node ",
        "valgrind ",
    ];
    let command = commands.iter().any(|command| line.contains(command));
    command && (line.starts_with("$ ") || line.contains('`')) || line.contains("](")
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str =
        "| N | steps |\n| --- | --- |\n| a | 1 |\n| b | 2 |\n| c | 3 |\n| d | 4 |\n";

    #[test]
    fn numbers_without_a_command_are_found() {
        let found = check(&File::new("docs/a.md", &format!("Text.\n\n{TABLE}")));
        assert_eq!((found.len(), found[0].line), (1, 3));
        for source in ["$ cargo bench", "By `jcas bench`.", "See [results](r.md)."] {
            let text = format!("{source}\n\n{TABLE}");
            assert!(check(&File::new("docs/a.md", &text)).is_empty(), "{source}");
        }
        let far = format!("$ cargo bench\n{}{TABLE}", "\n".repeat(30));
        assert_eq!(check(&File::new("docs/a.md", &far)).len(), 1);
        let words = TABLE.replace(['1', '2', '3', '4'], "word");
        assert!(check(&File::new("docs/a.md", &words)).is_empty());
    }
}
