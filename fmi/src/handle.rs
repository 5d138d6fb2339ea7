//! An instance behind the importer's pointer, and the importer's other pointers, once checked for
//! null. No panic crosses: a caught one is `fmi3Fatal`.

use std::ffi::{CString, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::slice;

use crate::instance::Instance;

/// `fmi3Status`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// Done, with a remark.
    Warning = 1,
    /// Not done; other values may be tried.
    Discard = 2,
    /// Not done.
    Error = 3,
    /// The instance is lost.
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
    /// Texts that were handed out last; the standard lets them live until the next call.
    pub(crate) texts: Vec<CString>,
}

impl Handle {
    pub(crate) fn say(&self, status: Status, message: &str) {
        let Some(log) = self.log else { return };
        if !self.logging {
            return;
        }
        let text = CString::new(message.replace('\0', " ")).unwrap_or_default();
        // The importer's own function, with its own environment and two texts that outlive the
        // call.
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

/// Runs a call on an instance: null is an error, a refusal is logged, a panic is fatal.
pub(crate) fn call(
    handle: *mut Handle,
    act: impl FnOnce(&mut Handle) -> Result<(), String>,
) -> Status {
    // The importer passes what instantiation returned and has not freed, from one thread at a time.
    let Some(handle) = (unsafe { handle.as_mut() }) else {
        return Status::Error;
    };
    match catch_unwind(AssertUnwindSafe(|| act(handle))) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(message)) => {
            handle.say(Status::Error, &message);
            Status::Error
        }
        Err(_) => {
            handle.say(Status::Fatal, "a fault inside the unit");
            Status::Fatal
        }
    }
}

/// The importer's array; empty where there is none.
pub(crate) unsafe fn read<'a, T>(
    pointer: *const T,
    count: usize,
    what: &str,
) -> Result<&'a [T], String> {
    if count == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() {
        return Err(format!("{what} is null"));
    }
    // Not null; `count` elements by the importer's word.
    Ok(unsafe { slice::from_raw_parts(pointer, count) })
}

pub(crate) unsafe fn write<'a, T>(
    pointer: *mut T,
    count: usize,
    what: &str,
) -> Result<&'a mut [T], String> {
    if count == 0 {
        return Ok(&mut []);
    }
    if pointer.is_null() {
        return Err(format!("{what} is null"));
    }
    // As above, and not shared while the call lasts.
    Ok(unsafe { slice::from_raw_parts_mut(pointer, count) })
}

pub(crate) unsafe fn give<T>(pointer: *mut T, value: T) {
    if !pointer.is_null() {
        // Not null; one element by the standard.
        unsafe { pointer.write(value) }
    }
}
