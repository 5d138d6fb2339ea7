//! The versions of the library and of the interface.

use std::ffi::c_char;

use crate::status::{JCAS_ERROR_ABI, JCAS_OK, jcas_status};

/// The version of the library that this header belongs to.
pub const JCAS_VERSION_MAJOR: u32 = 0;
/// See JCAS_VERSION_MAJOR.
pub const JCAS_VERSION_MINOR: u32 = 1;
/// See JCAS_VERSION_MAJOR.
pub const JCAS_VERSION_PATCH: u32 = 0;

/// The version of the interface that this header declares: 16777216 * major + 65536 * minor. It is
/// counted apart from the library's version, as most releases do not change it. Version 1.0 is the
/// first release; no release serves headers of major version 0.
pub const JCAS_ABI_VERSION: u32 = 0x0100_0000;

/// Returns the version of the library that runs, such as "0.1.0", as a static string.
/// Threads: any.
#[unsafe(no_mangle)]
pub extern "C" fn jcas_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// Returns the version of the interface of the library that runs.
/// Threads: any.
#[unsafe(no_mangle)]
pub extern "C" fn jcas_abi_version() -> u32 {
    JCAS_ABI_VERSION
}

/// Checks that the library that runs serves a program compiled with this header:
/// `jcas_abi_check(JCAS_ABI_VERSION)`. It does if the major versions are equal and the header's
/// minor version is not later. Make this call first: other calls cannot distinguish another version
/// from a wrong size.
/// Threads: any.
/// Statuses: ABI.
#[must_use]
#[unsafe(no_mangle)]
pub extern "C" fn jcas_abi_check(header_abi_version: u32) -> jcas_status {
    let same_major = header_abi_version >> 24 == JCAS_ABI_VERSION >> 24;
    if same_major && header_abi_version <= JCAS_ABI_VERSION {
        JCAS_OK
    } else {
        JCAS_ERROR_ABI
    }
}
