//! Progress with the remaining time on standard error, shown only on a terminal.

use core::fmt;

use indicatif::{ProgressBar, ProgressState, ProgressStyle};

/// Makes a progress bar over `count` items.
pub fn bar(count: u64, what: &str) -> ProgressBar {
    let style = ProgressStyle::with_template(
        "{msg} [{bar:32}] {human_pos}/{human_len} {rate} {elapsed} elapsed, {eta} left",
    )
    .expect("the template is valid")
    .with_key("rate", |state: &ProgressState, out: &mut dyn fmt::Write| {
        // A bar that cannot be written is shown without it.
        let _written = write!(out, "{:.0}/s", state.per_sec());
    })
    .progress_chars("=> ");
    ProgressBar::new(count)
        .with_style(style)
        .with_message(what.to_owned())
}
