//! The functions that a WebAssembly host calls; it reads the report from the module's memory.

use std::sync::LazyLock;

use crate::{Report, verify_all};

static REPORT: LazyLock<Report> = LazyLock::new(verify_all);

/// Verifies all traces. Returns the number of traces that differ.
#[unsafe(no_mangle)]
pub extern "C" fn failures() -> u32 {
    REPORT.failures
}

/// Returns the address of the report's text.
#[unsafe(no_mangle)]
pub extern "C" fn report() -> *const u8 {
    REPORT.text.as_ptr()
}

/// Returns the length of the report's text in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn report_len() -> usize {
    REPORT.text.len()
}
