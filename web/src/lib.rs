//! The playground: a page on which a person changes a mission while it flies.
//!
//! A mission is a pure function of what was asked: configuration, policy, seed, and the deeds of
//! the person (a hotspot dragged, a UAV grounded or steered, each at a step). After every change
//! the whole mission is flown again, which takes milliseconds, and the page plays it as it plays
//! any recorded episode. So the address of the page can hold the question, and whoever opens it
//! sees the same mission, bit for bit.
//!
//! [`answer`] is the one door, text in and text out. In a browser it is WebAssembly (`wasm.rs`);
//! behind
//! `jcas play` the same function answers over the loopback interface.

pub mod about;
pub mod mission;
pub mod page;
#[cfg(target_family = "wasm")]
mod wasm;

use serde::Deserialize;

/// What a page asks.
#[derive(Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case", deny_unknown_fields)]
enum Question {
    /// What can be asked: fields, presets, policies.
    About,
    /// A whole mission.
    Fly(mission::Mission),
}

/// Answers a question in JSON with JSON: `{"error": "..."}` where it cannot be answered.
#[must_use]
pub fn answer(question: &str) -> String {
    let answered = serde_json::from_str(question)
        .map_err(|error| format!("the question cannot be read: {error}"))
        .and_then(|question| match question {
            Question::About => Ok(about::about()),
            Question::Fly(mission) => mission.fly(),
        });
    answered.unwrap_or_else(|error| serde_json::json!({ "error": error }).to_string())
}
