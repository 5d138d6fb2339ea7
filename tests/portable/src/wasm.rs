//! What a WebAssembly host calls: it reads the report's bytes out of the module's memory.

use std::sync::LazyLock;

use crate::{Report, verify_all};

static REPORT: LazyLock<Report> = LazyLock::new(verify_all);

/// Verifies all traces; how many differ.
#[unsafe(no_mangle)]
pub extern "C" fn failures() -> u32 {
    REPORT.failures
}

/// Where the report's text begins.
#[unsafe(no_mangle)]
pub extern "C" fn report() -> *const u8 {
    REPORT.text.as_ptr()
}

/// Bytes of the report's text.
#[unsafe(no_mangle)]
pub extern "C" fn report_len() -> usize {
    REPORT.text.len()
}
