//! Traces with a right checksum: the reader refuses the text, or the kernel verifies it.

#![no_main]

use jcas_episode::trace::{self, CHECKSUM};
use jcas_fuzz::checksum;
use libfuzzer_sys::fuzz_target;

/// Larger episodes are read, and not run again.
const MOST_WORK: u64 = 100_000;

/// Replaces the checksum by that of the text before it.
fn with_checksum(text: &str) -> String {
    let Some(at) = text.rfind(CHECKSUM) else {
        return text.to_owned();
    };
    format!(
        "{}{CHECKSUM}{:016x}\"}}\n",
        &text[..at],
        checksum(text[..at].as_bytes())
    )
}

fuzz_target!(|text: &str| {
    let text = with_checksum(text);
    let Ok(read) = trace::read(text.as_bytes()) else {
        return;
    };
    let config = &read.header.config;
    let cells = u64::from(config.grid_width) * u64::from(config.grid_height);
    let fleet = u64::from(config.uav_count) * u64::from(config.uav_count + config.hotspot_count);
    if (cells + fleet) * (read.steps.len() as u64 + 1) <= MOST_WORK {
        let _ = trace::verify(&read);
    }
});
