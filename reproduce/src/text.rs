//! Small helpers of pages.

/// With a capital first letter.
pub(crate) fn capital(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or(String::new(), |first| {
        first.to_uppercase().chain(characters).collect()
    })
}

/// A Markdown table.
pub(crate) fn table<const K: usize>(head: [&str; K], rows: &[[String; K]]) -> String {
    let mut text = format!("| {} |\n|{}\n", head.join(" | "), " --- |".repeat(K));
    for row in rows {
        text += &format!("| {} |\n", row.join(" | "));
    }
    text
}
