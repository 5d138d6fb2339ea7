//! Small helpers of pages.

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
