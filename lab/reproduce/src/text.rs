//! Small helpers of pages.

use jcas_episode::statistics::Estimate;

/// A value with its interval.
pub(crate) fn told(e: &Estimate, digits: usize) -> String {
    let Estimate { value, low, high } = e;
    format!("{value:.digits$} [{low:.digits$}, {high:.digits$}]")
}

/// With a capital first letter.
pub(crate) fn capital(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or(String::new(), |first| {
        first.to_uppercase().chain(characters).collect()
    })
}

/// Numbers with commas.
pub(crate) fn list(numbers: &[u32]) -> String {
    let numbers: Vec<String> = numbers.iter().map(u32::to_string).collect();
    numbers.join(", ")
}

/// Paragraphs with lines of at most 100 columns, as far as single words allow.
pub(crate) fn wrapped(text: &str) -> String {
    const COLUMNS: usize = 100;
    let mut lines: Vec<String> = Vec::new();
    for paragraph in text.trim_end().split('\n') {
        let indent = if paragraph.starts_with("- ") {
            "  "
        } else {
            ""
        };
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > COLUMNS {
                lines.push(std::mem::replace(&mut line, indent.to_owned()));
            }
            if !line.trim_start().is_empty() {
                line.push(' ');
            }
            line += word;
        }
        lines.push(line);
    }
    lines.join("\n") + "\n"
}

/// A Markdown table.
pub(crate) fn table<T: AsRef<str>, R: AsRef<[String]>>(head: &[T], rows: &[R]) -> String {
    let heads: Vec<&str> = head.iter().map(AsRef::as_ref).collect();
    let mut text = format!(
        "| {} |\n|{}\n",
        heads.join(" | "),
        " --- |".repeat(head.len())
    );
    for row in rows {
        text += &format!("| {} |\n", row.as_ref().join(" | "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paragraphs_are_wrapped_and_stay_apart() {
        let word = "x".repeat(49);
        let text = format!("{word} {word} {word}  y\n\nz");
        // 49 + 1 + 49 columns fit, a third word does not.
        assert_eq!(wrapped(&text), format!("{word} {word}\n{word} y\n\nz\n"));
        let item = wrapped(&format!("- {word} {word}"));
        assert_eq!(item, format!("- {word}\n  {word}\n"));
    }
}
