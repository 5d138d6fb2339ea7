//! One self-contained HTML page that plays an episode from its trace.
//!
//! The page is a hand-written template with its style, its code and the episode inside: it loads
//! nothing.

mod episode;

use episode::Episode;

use crate::trace::{self, Trace, TraceError};

const TEMPLATE: &str = include_str!("template.html");
const STYLE: &str = include_str!("style.css");

/// In the order in which one file uses another's functions; together they are one script.
const SCRIPTS: [&str; 5] = [
    include_str!("episode.js"),
    include_str!("stage.js"),
    include_str!("charts.js"),
    include_str!("panels.js"),
    include_str!("player.js"),
];

/// The page that plays the episode of `trace_text` (JSON lines).
///
/// # Errors
/// When the text is not a whole trace of this format.
pub fn page(trace_text: &str) -> Result<String, TraceError> {
    page_of(&trace::read(trace_text.as_bytes())?)
}

/// The page that plays the episode of a trace.
///
/// # Errors
/// When a list of the trace has the wrong length, or holds a cell or an index that does not exist.
pub fn page_of(trace: &Trace) -> Result<String, TraceError> {
    let episode = Episode::of(trace)?;
    Ok(assemble(&Parts {
        title: &episode.title(),
        data: &episode.to_json(),
        ..Parts::default()
    }))
}

/// What one page has and another has not.
#[derive(Clone, Copy, Debug)]
pub struct Parts<'a> {
    /// What the browser's tab shows.
    pub title: &'a str,
    /// Sources that the page may use beside its own style and pictures, as a
    /// Content-Security-Policy.
    pub sources: &'a str,
    /// Rules added to the style sheet.
    pub style: &'a str,
    /// Markup between the masthead and the map.
    pub controls: &'a str,
    /// The episode to show first, as [`data_of`] gives it, or `null`.
    pub data: &'a str,
    /// Code after the player's own.
    pub script: &'a str,
}

impl Default for Parts<'_> {
    fn default() -> Self {
        Self {
            title: "",
            sources: "script-src 'unsafe-inline'",
            style: "",
            controls: "",
            data: "null",
            script: "",
        }
    }
}

/// The page of a player, with what is given.
#[must_use]
pub fn assemble(parts: &Parts<'_>) -> String {
    let style = [STYLE.trim_end(), parts.style].join("\n");
    let script = [SCRIPTS.join("\n").trim_end(), parts.script].join("\n");
    fill(
        TEMPLATE,
        &[
            ("{{sources}}", parts.sources),
            ("{{title}}", &escape_html(parts.title)),
            ("{{style}}", style.trim_end()),
            ("{{controls}}", parts.controls),
            ("{{data}}", &escape_script_data(parts.data)),
            ("{{script}}", script.trim_end()),
        ],
    )
}

/// The page's own JSON of an episode.
///
/// # Errors
/// As [`page_of`].
pub fn data_of(trace: &Trace) -> Result<String, TraceError> {
    Ok(Episode::of(trace)?.to_json())
}

/// Puts each value at its mark. The marks stand in this order in the template, and one pass over it
/// leaves alone whatever looks like a mark inside a value.
fn fill(template: &str, values: &[(&str, &str)]) -> String {
    let mut page = String::with_capacity(
        template.len() + values.iter().map(|(_, value)| value.len()).sum::<usize>(),
    );
    let mut rest = template;
    for (mark, value) in values {
        let (before, after) = rest
            .split_once(mark)
            .expect("the template holds each mark once, in order");
        page.push_str(before);
        page.push_str(value);
        rest = after;
    }
    page.push_str(rest);
    page
}

fn escape_html(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

/// JSON stays the same JSON, but holds no `<` that could end the script element or open a comment
/// in it.
fn escape_script_data(json: &str) -> String {
    json.replace('<', "\\u003c")
}

#[cfg(test)]
mod tests;
