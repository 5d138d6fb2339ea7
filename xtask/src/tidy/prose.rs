//! Paragraphs of comments and documents, without code.

use super::files::{File, Language};

/// A run of sentences without a break.
#[derive(Debug, Default, PartialEq)]
pub struct Paragraph {
    /// Line number of its first line, from 1.
    pub line: usize,
    pub text: String,
}

/// What opens and closes a Python string of several lines.
const MARK: &str = "\"\"\"";

/// What a line begins in.
#[derive(Clone, Copy, PartialEq)]
enum Within {
    Code,
    Comment,
    /// A Python string of several lines that is data, not a docstring.
    String,
}

/// The paragraphs of a file: comments of a source, running text of a document.
pub fn paragraphs(file: &File) -> Vec<Paragraph> {
    let mut found: Vec<Paragraph> = Vec::new();
    let mut open = false;
    let mut in_code = false;
    let mut within = Within::Code;
    for (index, line) in file.text.lines().enumerate() {
        let prose = prose_of(line, file.language, &mut within).map(str::trim);
        let Some(prose) = prose else {
            open = false;
            continue;
        };
        if prose.starts_with("```") {
            in_code = !in_code;
            open = false;
            continue;
        }
        let skipped = prose.is_empty() || prose.starts_with(['|', '#', '$', '>', '!']);
        if in_code || skipped {
            open = false;
            continue;
        }
        let item = prose
            .strip_prefix("- ")
            .or_else(|| prose.strip_prefix("* "));
        if !open || item.is_some() || numbered(prose) {
            found.push(Paragraph {
                line: index + 1,
                text: String::new(),
            });
            open = true;
        }
        if let Some(paragraph) = found.last_mut() {
            paragraph.text.push_str(item.unwrap_or(prose));
            paragraph.text.push(' ');
        }
    }
    for paragraph in &mut found {
        paragraph.text = plain(&paragraph.text);
    }
    found
}

/// The prose of a line, or `None` where it is code.
fn prose_of<'a>(line: &'a str, language: Language, within: &mut Within) -> Option<&'a str> {
    let trimmed = line.trim_start();
    match language {
        Language::Markdown => Some(line),
        Language::Rust | Language::Braces => {
            if *within == Within::Comment || trimmed.starts_with("/*") {
                *within = if line.contains("*/") {
                    Within::Code
                } else {
                    Within::Comment
                };
                let inner = trimmed.trim_start_matches(['/', '*']);
                return Some(inner.trim_end().trim_end_matches("*/"));
            }
            let comment = trimmed.strip_prefix("//")?;
            Some(comment.trim_start_matches(['/', '!']))
        }
        Language::Python if *within != Within::Code || trimmed.contains(MARK) => {
            let begun = match *within {
                Within::Code if trimmed.starts_with(MARK) => Within::Comment,
                Within::Code => Within::String,
                begun => begun,
            };
            if trimmed.matches(MARK).count() % 2 == 1 {
                *within = if *within == Within::Code {
                    begun
                } else {
                    Within::Code
                };
            }
            (begun == Within::Comment).then(|| trimmed.trim_matches('"'))
        }
        Language::Python | Language::Hashes => {
            let comment = trimmed.strip_prefix('#')?;
            (!comment.starts_with('!')).then_some(comment)
        }
        Language::Other => None,
    }
}

/// Whether a line begins an item such as "2. ".
fn numbered(line: &str) -> bool {
    line.split_once(". ")
        .is_some_and(|(number, _)| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
}

/// The text with each `code` span as one word and each link as its words.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    for (index, part) in text.split('`').enumerate() {
        plain.push_str(if index % 2 == 0 { part } else { "Code" });
    }
    while let Some(begin) = plain.find("](") {
        let end = plain[begin..]
            .find(')')
            .map_or(plain.len(), |end| begin + end + 1);
        plain.replace_range(begin..end, "");
    }
    plain.replace('[', "").trim().to_owned()
}

/// The sentences of a paragraph: each ends with a full stop, a question or an exclamation mark.
pub fn sentences(text: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut begin = 0;
    for (at, mark) in text
        .char_indices()
        .filter(|(_, c)| ['.', '?', '!'].contains(c))
    {
        let rest = &text[at + mark.len_utf8()..];
        let rest = rest.trim_start_matches([')', '"', '*']);
        let next = rest.trim_start().chars().next();
        let ends =
            rest.is_empty() || rest.starts_with(' ') && next.is_none_or(|c| !c.is_lowercase());
        if ends {
            let end = text.len() - rest.len();
            found.push(text[begin..end].trim());
            begin = end;
        }
    }
    found.push(text[begin..].trim());
    found.retain(|sentence| !sentence.is_empty());
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(path: &str, text: &str) -> Vec<(usize, String)> {
        let found = paragraphs(&File::new(path, text));
        found.into_iter().map(|p| (p.line, p.text)).collect()
    }

    #[test]
    fn comments_are_read_and_code_is_not() {
        let rust = "//! One `x + y` is\n//! this.\nlet a = 1; // no\n/* Two\n * lines. */\n\
                    /// ```\n/// code\n/// ```\n";
        let expected = [
            (1, "One Code is this.".to_owned()),
            (4, "Two lines.".to_owned()),
        ];
        assert_eq!(texts("a.rs", rust), expected);
        let python = "#!/usr/bin/env python3\n# One.\n\"\"\"Two\nlines.\"\"\"\nx = 1\n";
        let expected = [(2, "One. Two lines.".to_owned())];
        assert_eq!(texts("a.py", python), expected);
        let data = "TEXT = \"\"\"\nno prose\n\"\"\"\ndef f():\n    \"\"\"Three.\"\"\"\n";
        assert_eq!(texts("a.py", data), [(5, "Three.".to_owned())]);
        let document = "# Title\n\nSee [this](a.md) page.\n- An item\n| a | 1 |\n```\ncode\n```\n";
        let expected = [(3, "See this page.".to_owned()), (4, "An item".to_owned())];
        assert_eq!(texts("a.md", document), expected);
    }

    #[test]
    fn a_sentence_ends_before_a_capital() {
        let text = "It is 1.5 of e.g. these. Then (so.) Who? none";
        let expected = ["It is 1.5 of e.g. these.", "Then (so.)", "Who? none"];
        assert_eq!(sentences(text), expected);
    }
}
