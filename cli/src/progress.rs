//! Progress with the remaining time on standard error, shown only on a terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// Makes a progress bar over `count` items.
pub fn bar(count: u64, what: &str) -> ProgressBar {
    let style = ProgressStyle::with_template(
        "{msg} [{bar:32}] {human_pos}/{human_len} {per_sec} {elapsed} elapsed, {eta} left",
    )
    .expect("the template is valid")
    .progress_chars("=> ");
    ProgressBar::new(count)
        .with_style(style)
        .with_message(what.to_owned())
}
