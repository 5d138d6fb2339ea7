//! Vague words that a reader has to guess at.

use super::Finding;
use super::files::File;
use super::prose::{paragraphs, sentences};

/// Phrases to avoid, in lower case.
const BANNED: [&str; 9] = [
    "so many",
    "what is told",
    "is told",
    "are told",
    "who",
    "whatever",
    "that there is",
    "that there are",
    "be spared",
];

/// Finds banned phrases in comments and documents, and sentences with a banned end.
pub fn check(file: &File) -> Vec<Finding> {
    let mut findings = Vec::new();
    for paragraph in paragraphs(file) {
        for sentence in sentences(&paragraph.text) {
            for phrase in phrases(sentence) {
                findings.push(Finding {
                    rule: "words",
                    path: file.path.clone(),
                    line: paragraph.line,
                    what: format!("\"{phrase}\" in \"{sentence}\""),
                });
            }
        }
    }
    findings
}

fn phrases(sentence: &str) -> Vec<&'static str> {
    let lower = sentence.to_lowercase();
    let words: Vec<&str> = lower
        .split(|c: char| !c.is_alphanumeric() && c != '\'')
        .collect();
    let words: Vec<&str> = words.into_iter().filter(|word| !word.is_empty()).collect();
    let text = format!(" {} ", words.join(" "));
    let mut found: Vec<&str> = BANNED
        .into_iter()
        .filter(|phrase| text.contains(&format!(" {phrase} ")))
        .collect();
    if text.ends_with(" of it ") {
        found.push("of it");
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn banned_words_are_found_in_comments_only() {
        let text = "// Of so many threads, whatever\n// they do. Half of it.\nlet who = 1;\n";
        let found = check(&File::new("core/src/a.rs", text));
        let phrases: Vec<_> = found
            .iter()
            .map(|f| f.what.split('"').nth(1).unwrap())
            .collect();
        assert_eq!(phrases, ["so many", "whatever", "of it"]);
        let fine = "// The whole of its memory. Part of it is used.\n";
        assert!(check(&File::new("core/src/a.rs", fine)).is_empty());
    }
}
