//! A table in Markdown, written to a temporary name and then renamed.

use std::path::Path;

/// Rows of equal length, the first of them the heading.
pub fn table(rows: &[Vec<String>]) -> String {
    let mut text = String::new();
    for (index, row) in rows.iter().enumerate() {
        text.push_str(&format!("| {} |\n", row.join(" | ")));
        if index == 0 {
            text.push_str(&format!("|{}\n", " --- |".repeat(row.len())));
        }
    }
    text
}

/// Writes a file whole or not at all.
pub fn write(path: &Path, text: &str) -> Result<(), String> {
    let explain = |error: std::io::Error| format!("{}: {error}", path.display());
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(explain)?;
    }
    let partial = path.with_extension("partial");
    std::fs::write(&partial, text).map_err(explain)?;
    std::fs::rename(&partial, path).map_err(explain)
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_heading_is_underlined() {
        let rows = [
            vec!["a".to_owned(), "b".to_owned()],
            vec!["1".to_owned(), "2".to_owned()],
        ];
        assert_eq!(super::table(&rows), "| a | b |\n| --- | --- |\n| 1 | 2 |\n");
    }
}
