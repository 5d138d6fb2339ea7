//! An instance behind the importer's pointer, and slices from its other pointers after a check for
//! null. No panic crosses the interface: a caught one becomes `fmi3Fatal`.

use std::ffi::{CString, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::slice;

use crate::error::Error;
use crate::instance::Instance;

/// The `fmi3Status` of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum Status {
    /// The call succeeded.
    Ok = 0,
    /// The call succeeded with a warning.
    Warning = 1,
    /// The call was discarded; other values may be tried.
    Discard = 2,
    /// The call failed.
    Error = 3,
    /// The instance can no longer be used.
    Fatal = 4,
}

pub(crate) type LogMessage =
    Option<unsafe extern "C" fn(*mut c_void, Status, *const c_char, *const c_char)>;

/// An instance as the importer holds it.
pub struct Handle {
    pub(crate) instance: Instance,
    pub(crate) log: LogMessage,
    pub(crate) logging: bool,
    pub(crate) environment: *mut c_void,
    /// The texts of the last get. The standard keeps them valid until the next call.
    pub(crate) texts: Vec<CString>,
}

impl Handle {
    pub(crate) fn say(&self, status: Status, message: &str) {
        let Some(log) = self.log else { return };
        if !self.logging {
            return;
        }
        let text = CString::new(message.replace('\0', " ")).unwrap_or_default();
        // The function and its environment are the importer's, and both texts outlive the call.
        unsafe {
            log(
                self.environment,
                status,
                c"logStatusError".as_ptr(),
                text.as_ptr(),
            )
        }
    }
}

/// Runs a call on an instance. Null is an error, a refusal is logged and a panic is fatal.
pub(crate) fn call(
    handle: *mut Handle,
    act: impl FnOnce(&mut Handle) -> Result<(), Error>,
) -> Status {
    // The importer passes what instantiation returned and has not freed, from one thread at a time.
    let Some(handle) = (unsafe { handle.as_mut() }) else {
        return Status::Error;
    };
    match catch_unwind(AssertUnwindSafe(|| act(handle))) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(error)) => {
            handle.say(Status::Error, &error.to_string());
            Status::Error
        }
        Err(_) => {
            handle.say(Status::Fatal, "a fault inside the unit");
            Status::Fatal
        }
    }
}

/// Reads the importer's array, which is empty if the pointer is null.
pub(crate) unsafe fn read<'a, T>(
    pointer: *const T,
    count: usize,
    what: &str,
) -> Result<&'a [T], Error> {
    if count == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() {
        return Err(Error::Null(what.to_owned()));
    }
    // It is not null and has `count` elements, as the importer promises.
    Ok(unsafe { slice::from_raw_parts(pointer, count) })
}

pub(crate) unsafe fn write<'a, T>(
    pointer: *mut T,
    count: usize,
    what: &str,
) -> Result<&'a mut [T], Error> {
    if count == 0 {
        return Ok(&mut []);
    }
    if pointer.is_null() {
        return Err(Error::Null(what.to_owned()));
    }
    // As above, and nothing else uses it during the call.
    Ok(unsafe { slice::from_raw_parts_mut(pointer, count) })
}

pub(crate) unsafe fn give<T>(pointer: *mut T, value: T) {
    if !pointer.is_null() {
        // It is not null and has one element by the standard.
        unsafe { pointer.write(value) }
    }
}
