//! Sentences of comments and documents: at most 25 words, and no vague word.

use super::File;

const WORDS_MAX: usize = 25;

/// Phrases that a reader has to guess at, in lower case.
const VAGUE: &str = "so many, who, whatever, that there is, that there are, be spared";

/// Finds sentences that are too long and sentences with a vague phrase.
pub fn check(file: &File) -> Vec<String> {
    let mut findings = Vec::new();
    for (line, text) in paragraphs(file) {
        for sentence in sentences(&text) {
            let lower = sentence.to_lowercase();
            let words = lower.split_whitespace();
            let words = words.map(|word| word.trim_matches(|c: char| !c.is_alphanumeric()));
            let words: Vec<_> = words.filter(|word| !word.is_empty()).collect();
            let joined = format!(" {} ", words.join(" "));
            let mut find = |what| {
                findings.push(format!("{}:{line}: {what} in \"{sentence}\"", file.path));
            };
            if words.len() > WORDS_MAX {
                find(format!("{} words", words.len()));
            }
            let is_in = |phrase: &&str| joined.contains(&format!(" {phrase} "));
            VAGUE
                .split(", ")
                .filter(is_in)
                .for_each(|phrase| find(format!("\"{phrase}\"")));
        }
    }
    findings
}

/// The paragraphs of comments, or of a document, with the lines where they begin. Code, tables and
/// headings are left out.
fn paragraphs(file: &File) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let (mut is_open, mut is_fenced, mut string) = (false, false, None);
    let suffix = file.path.rsplit('.').next().unwrap_or("");
    for (index, line) in file.text.lines().enumerate() {
        let prose = prose_of(line, suffix, &mut string).map_or("", str::trim);
        let is_fence = prose.starts_with("```");
        is_fenced ^= is_fence;
        let is_code = is_fence || is_fenced || prose.is_empty();
        if is_code || prose.starts_with(['|', '#', '$', '>', '!']) {
            is_open = false;
            continue;
        }
        let item = prose.strip_prefix(['-', '*']).unwrap_or(prose);
        let number = prose.split_once(". ").map_or("", |(number, _)| number);
        let is_numbered = number.parse::<u32>().is_ok();
        let is_entry = suffix == "py" && is_entry(prose);
        if !is_open || is_numbered || is_entry || item.starts_with(' ') {
            found.push((index + 1, String::new()));
            is_open = true;
        }
        if let Some((_, text)) = found.last_mut() {
            *text += item.trim();
            text.push(' ');
        }
    }
    found.iter_mut().for_each(|(_, text)| *text = plain(text));
    found
}

/// Whether a line of a docstring begins the entry of a parameter: `name: text`.
fn is_entry(prose: &str) -> bool {
    let name = prose.split_once(": ").map_or("", |(name, _)| name);
    let name = name.trim_start_matches('*');
    !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_')
}

/// The prose of a line, or `None` where it is code. `string` says whether a Python string of
/// several lines is open, and then whether it is a docstring.
fn prose_of<'a>(line: &'a str, suffix: &str, string: &mut Option<bool>) -> Option<&'a str> {
    let text = line.trim();
    match suffix {
        "md" => Some(line),
        "rs" | "c" | "cc" | "cpp" | "h" | "hpp" | "js" | "mjs" => {
            let block = text.strip_prefix("/*").or(text.strip_prefix("* "));
            let line = text.strip_prefix("//");
            line.map(|rest| rest.trim_start_matches(['/', '!']))
                .or(block.map(|rest| rest.trim_end_matches("*/")))
        }
        "py" => {
            let begun = *string;
            let is_docstring = begun.unwrap_or(text.starts_with("\"\"\""));
            if text.matches("\"\"\"").count() % 2 == 1 {
                *string = begun.is_none().then_some(is_docstring);
            }
            let comment = text.strip_prefix('#').filter(|_| begun.is_none());
            comment.or(is_docstring.then_some(text.trim_matches('"')))
        }
        "sh" | "toml" | "yml" | "cmake" => text.strip_prefix('#'),
        _ => None,
    }
}

/// The text with each `code` span as one word and each link as its words.
fn plain(text: &str) -> String {
    let spans = text.split('`').enumerate();
    let words = spans.map(|(index, part)| if index % 2 == 0 { part } else { "Code" });
    let mut plain = words.collect::<String>();
    while let Some(begin) = plain.find("](") {
        let end = plain[begin..]
            .find(')')
            .map_or(plain.len(), |end| begin + end + 1);
        plain.replace_range(begin..end, "");
    }
    plain.replace('[', "").trim().to_owned()
}

/// The sentences of a paragraph: each ends with a mark that no lower-case word follows.
fn sentences(text: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut begin = 0;
    for (at, mark) in text.match_indices(['.', '?', '!']) {
        let rest = text[at + mark.len()..].trim_start_matches([')', '"', '*']);
        let next = rest.trim_start().chars().next();
        if rest.is_empty() || rest.starts_with(' ') && next.is_none_or(|c| !c.is_lowercase()) {
            let end = text.len() - rest.len();
            found.push(text[begin..end].trim());
            begin = end;
        }
    }
    found.push(text[begin..].trim());
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(path: &str, text: &str) -> Vec<(usize, String)> {
        let (path, text) = (path.to_owned(), text.to_owned());
        paragraphs(&File { path, text })
    }

    #[test]
    fn comments_are_prose_and_code_is_not() {
        let rust = "//! One `x + y` is\n//! this.\nlet a = 1; // no\n/* Two\n * lines. */\n\
                    /// ```\n/// code\n/// ```\n";
        let two = (4, "Two lines.".to_owned());
        assert_eq!(
            found("a.rs", rust),
            [(1, "One Code is this.".to_owned()), two]
        );
        let python = "#!/usr/bin/python\nTEXT = \"\"\"\nno prose\n\"\"\"\ndef f():\n    \
                      \"\"\"Three\n    lines.\"\"\"\n    x = 1  # no\n    # One.\n";
        let three = (6, "Three lines.".to_owned());
        assert_eq!(found("a.py", python), [three, (9, "One.".to_owned())]);
        let entries = "\"\"\"Args:\n    a: one of\n        two\n    **b_c: x\n\"\"\"\n";
        let texts: Vec<_> = found("a.py", entries)
            .into_iter()
            .map(|(_, text)| text)
            .collect();
        assert_eq!(texts, ["Args:", "a: one of two", "*b_c: x"]);
        let document = "# Title\n\nSee [this](a.md) page.\n- An item\n| a | 1 |\n```\ncode\n```\n";
        let page = (3, "See this page.".to_owned());
        assert_eq!(found("a.md", document), [page, (4, "An item".to_owned())]);
    }

    #[test]
    fn long_and_vague_sentences_are_found() {
        let words = "word ".repeat(24);
        let text =
            format!("Short (one.) Word {words}end.\n\n{words}1.5. So many, whatever\nthey do.");
        let path = "a.md".to_owned();
        let findings = check(&File { path, text });
        assert_eq!(findings.len(), 3, "{findings:?}");
        assert!(findings[0].starts_with("a.md:1: 26 words in \"Word word"));
        assert!(findings[1].starts_with("a.md:3: \"so many\""));
        assert!(findings[2].starts_with("a.md:3: \"whatever\""));
    }
}
