//! One self-contained HTML page that plays an episode from its trace.
//!
//! The page is a hand-written template that contains its style, its code and the episode: it loads
//! nothing.

mod episode;

use episode::Episode;
use jcas_core::{Config, Preset};
use jcas_policy::BaselineKind;
use serde_json::{Map, Value, json};

use crate::trace::{self, Trace, TraceError};

const TEMPLATE: &str = include_str!("template.html");
const STYLE: &str = include_str!("style.css");

/// The scripts in order: a file uses only functions of earlier files, and together they are one
/// script.
const SCRIPTS: [&str; 5] = [
    include_str!("episode.js"),
    include_str!("stage.js"),
    include_str!("charts.js"),
    include_str!("panels.js"),
    include_str!("player.js"),
];

/// Returns the page that plays the episode of `trace_text` (JSON lines).
///
/// # Errors
/// The text is not a complete trace of this format.
pub fn page(trace_text: &str) -> Result<String, TraceError> {
    page_of(&trace::read(trace_text.as_bytes())?)
}

/// Returns the page that plays the episode of a trace.
///
/// # Errors
/// A list of the trace has the wrong length, or holds a cell or an index that does not exist.
pub fn page_of(trace: &Trace) -> Result<String, TraceError> {
    let episode = Episode::of(trace)?;
    Ok(assemble(&Parts {
        title: &episode.title(),
        data: &episode.to_json(),
        ..Parts::default()
    }))
}

/// The parts in which pages differ.
#[derive(Clone, Copy, Debug)]
pub struct Parts<'a> {
    /// The title of the browser's tab.
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

/// Returns the page of a player with the given parts.
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
            ("{{presets}}", &presets()),
            ("{{data}}", &escape_script_data(parts.data)),
            ("{{script}}", script.trim_end()),
        ],
    )
}

/// Returns an episode in the page's own JSON.
///
/// # Errors
/// The errors are those of [`page_of`].
pub fn data_of(trace: &Trace) -> Result<String, TraceError> {
    Ok(Episode::of(trace)?.to_json())
}

/// The presets and the names of baselines, by which a page states the command for its episode.
/// The first preset has all of its fields, the others have those that differ from it.
fn presets() -> String {
    let first = json!(Config::preset(Preset::ALL[0]));
    let presets: Map<String, Value> = Preset::ALL
        .iter()
        .map(|preset| {
            let mut fields = json!(Config::preset(*preset));
            if let (Some(fields), true) = (fields.as_object_mut(), *preset != Preset::ALL[0]) {
                fields.retain(|name, value| first[name.as_str()] != *value);
            }
            (preset.name().to_owned(), fields)
        })
        .collect();
    let baselines = BaselineKind::ALL.map(BaselineKind::name);
    json!({ "first": Preset::ALL[0].name(), "presets": presets, "baselines": baselines })
        .to_string()
}

/// Replaces each mark by its value. The marks have this order in the template. One pass over the
/// template leaves text inside a value unchanged, even if it looks like a mark.
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

/// Escapes `<` in JSON, which then cannot end the script element or open a comment in it.
fn escape_script_data(json: &str) -> String {
    json.replace('<', "\\u003c")
}

#[cfg(test)]
mod tests;
