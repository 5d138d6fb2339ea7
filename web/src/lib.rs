//! The playground: a page on which a person changes an episode while it runs.
//!
//! An episode is a pure function of the request: configuration, policy, seed and interventions. An
//! intervention drags a hotspot, or grounds or steers a UAV, each at a step. After every change the
//! whole episode runs again within milliseconds, and the page plays the recorded episode. The
//! address of the page holds the request, so every reader of an address sees the same episode, bit
//! for bit.
//!
//! [`answer`] is the only entry point; it maps a text to a text. In a browser it is WebAssembly
//! (`wasm.rs`). Behind `jcas play` the same function answers over the loopback interface.

pub mod about;
pub mod episode;
mod error;
mod lines;
pub mod page;
mod scenes;
#[cfg(target_family = "wasm")]
mod wasm;

use error::Refusal;
use serde::Deserialize;

/// A request of a page.
#[derive(Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case", deny_unknown_fields)]
enum Question {
    /// Asks for the fields, presets and policies.
    About,
    /// Asks for a whole episode.
    Fly(episode::Episode),
}

/// Answers a JSON request with JSON: `{"error": "..."}` where the request is not valid.
#[must_use]
pub fn answer(question: &str) -> String {
    let refuse = |refusal: Refusal<'_>| serde_json::json!({ "error": refusal.to_string() });
    match serde_json::from_str(question) {
        Err(error) => refuse(Refusal::Question(error)).to_string(),
        Ok(Question::About) => about::about(),
        Ok(Question::Fly(episode)) => episode
            .fly()
            .unwrap_or_else(|refusal| refuse(refusal).to_string()),
    }
}
