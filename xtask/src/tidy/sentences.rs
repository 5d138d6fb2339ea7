//! Sentences of at most 25 words.

use super::Finding;
use super::files::File;
use super::prose::{paragraphs, sentences};

const WORDS_MAX: usize = 25;

/// Finds sentences in comments and documents that are too long.
pub fn check(file: &File) -> Vec<Finding> {
    let mut findings = Vec::new();
    for paragraph in paragraphs(file) {
        for sentence in sentences(&paragraph.text) {
            let words = sentence.split_whitespace();
            let count = words
                .filter(|word| word.contains(char::is_alphanumeric))
                .count();
            if count > WORDS_MAX {
                let begin: Vec<&str> = sentence.split_whitespace().take(8).collect();
                findings.push(Finding {
                    rule: "sentences",
                    path: file.path.clone(),
                    line: paragraph.line,
                    what: format!("{count} words, at most {WORDS_MAX}: {} …", begin.join(" ")),
                });
            }
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_sentence_is_found() {
        let text = format!("Short one.\n{}end.\n", "Word ".repeat(25));
        let found = check(&File::new("docs/a.md", &text));
        assert_eq!(found.len(), 1);
        assert!(found[0].what.starts_with("26 words"), "{}", found[0].what);
        let text = format!("{}. {}.\n", "word ".repeat(24), "Word ".repeat(25));
        assert!(check(&File::new("docs/a.md", &text)).is_empty());
    }
}
