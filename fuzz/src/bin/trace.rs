//! Traces with a right checksum: the reader refuses the text, or writes it back and verifies it.

#![no_main]

use jcas_episode::trace;
use jcas_fuzz::checksum;
use libfuzzer_sys::fuzz_target;

/// Larger episodes are read, and not flown again.
const MOST_WORK: u64 = 100_000;
const CHECKSUM: &str = ",\"checksum\":\"0x";

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
    let again = trace::read(read.to_text().as_bytes()).expect("a text that was written is read");
    // The checksum may differ: numbers can be written in several ways.
    assert_eq!(again.to_text(), read.to_text());
    let config = &read.header.config;
    let cells = u64::from(config.grid_width) * u64::from(config.grid_height);
    let fleet = u64::from(config.uav_count) * u64::from(config.uav_count + config.hotspot_count);
    if (cells + fleet) * (read.steps.len() as u64 + 1) <= MOST_WORK {
        let _ = trace::verify(&read);
    }
});
