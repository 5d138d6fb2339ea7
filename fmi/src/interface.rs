//! The functions of the standard for the life of an instance and its steps.

use std::ffi::{CStr, c_char, c_void};
use std::panic::catch_unwind;
use std::path::PathBuf;
use std::ptr::null_mut;

use crate::description::token;
use crate::error::Error;
use crate::handle::{Handle, LogMessage, Status, call, give};
use crate::instance::{Instance, Mode};

/// The version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// Turns messages on or off. There is one category.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3SetDebugLogging(
    handle: *mut Handle,
    on: bool,
    _count: usize,
    _categories: *const *const c_char,
) -> Status {
    call(handle, |handle| {
        handle.logging = on;
        Ok(())
    })
}

/// Creates an instance. The result is null for the token of another description, and if event mode
/// or intermediate updates are requested.
///
/// # Safety
/// Texts are null or end in 0.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    asked: *const c_char,
    resources: *const c_char,
    _visible: bool,
    logging: bool,
    event_mode: bool,
    _early_return: bool,
    _intermediate: *const u32,
    intermediate_count: usize,
    environment: *mut c_void,
    log: LogMessage,
    _update: Option<unsafe extern "C" fn()>,
) -> *mut Handle {
    let resources = if resources.is_null() {
        None
    } else {
        // The text belongs to the importer.
        let path = unsafe { CStr::from_ptr(resources) };
        path.to_str().ok().map(PathBuf::from)
    };
    let made = catch_unwind(|| Instance::new(resources).ok())
        .ok()
        .flatten();
    let Some(instance) = made else {
        return null_mut();
    };
    let handle = Handle {
        instance,
        log,
        logging,
        environment,
        texts: Vec::new(),
    };
    // The text belongs to the importer.
    let asked = if asked.is_null() {
        c""
    } else {
        unsafe { CStr::from_ptr(asked) }
    };
    if asked.to_bytes() != token().as_bytes() {
        handle.say(
            Status::Error,
            &format!(
                "instantiationToken = {}: this is {}",
                asked.to_string_lossy(),
                token()
            ),
        );
        return null_mut();
    }
    if event_mode {
        handle.say(
            Status::Error,
            "eventModeUsed = true: there is no event mode",
        );
        return null_mut();
    }
    if intermediate_count > 0 {
        handle.say(
            Status::Error,
            &format!(
                "nRequiredIntermediateVariables = {intermediate_count}: must be 0; \
                 there are no intermediate updates"
            ),
        );
        return null_mut();
    }
    Box::into_raw(Box::new(handle))
}

/// Frees an instance. Null is allowed and does nothing.
///
/// # Safety
/// `handle` is null, or was returned by instantiation and not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(handle: *mut Handle) {
    if !handle.is_null() {
        // The pointer is from Box::into_raw and is freed once.
        drop(unsafe { Box::from_raw(handle) });
    }
}

/// Enters initialization mode, in which parameters may be set.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3EnterInitializationMode(
    handle: *mut Handle,
    _tolerance_defined: bool,
    _tolerance: f64,
    start: f64,
    _stop_defined: bool,
    _stop: f64,
) -> Status {
    call(handle, |handle| {
        if !start.is_finite() {
            return Err(Error::Argument {
                argument: "startTime",
                value: start.to_string(),
                allowed: "must be a finite number".to_owned(),
            });
        }
        handle.instance.go(
            &[Mode::Instantiated],
            Mode::Initialization,
            "fmi3EnterInitializationMode",
        )?;
        handle.instance.start_at(start);
        Ok(())
    })
}

/// Exits initialization mode. The episode is then at its start.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3ExitInitializationMode(handle: *mut Handle) -> Status {
    call(handle, |handle| {
        if handle.instance.mode() == Mode::Initialization {
            handle.instance.prepare()?;
        }
        handle.instance.go(
            &[Mode::Initialization],
            Mode::Step,
            "fmi3ExitInitializationMode",
        )
    })
}

/// Enters configuration mode, in which sizes may be set.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3EnterConfigurationMode(handle: *mut Handle) -> Status {
    call(handle, |handle| {
        handle.instance.go(
            &[Mode::Instantiated],
            Mode::Configuration,
            "fmi3EnterConfigurationMode",
        )
    })
}

/// Exits configuration mode, which fixes the sizes.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3ExitConfigurationMode(handle: *mut Handle) -> Status {
    call(handle, |handle| {
        handle.instance.go(
            &[Mode::Configuration],
            Mode::Instantiated,
            "fmi3ExitConfigurationMode",
        )
    })
}

/// Terminates the simulation. No step may follow.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3Terminate(handle: *mut Handle) -> Status {
    call(handle, |handle| {
        handle
            .instance
            .go(&[Mode::Step], Mode::Terminated, "fmi3Terminate")
    })
}

/// Resets the instance to its state after instantiation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3Reset(handle: *mut Handle) -> Status {
    call(handle, |handle| handle.instance.reset())
}

/// Simulates one communication step, which is one or more whole steps of the kernel.
///
/// # Safety
/// The four outputs are null or point to one value each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    handle: *mut Handle,
    from: f64,
    length: f64,
    _no_set_state: bool,
    event: *mut bool,
    terminate: *mut bool,
    early: *mut bool,
    last: *mut f64,
) -> Status {
    call(handle, |handle| {
        let reached = handle.instance.do_step(from, length)?;
        unsafe {
            give(event, false);
            give(terminate, false);
            give(early, false);
            give(last, reached);
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::CString;
    use std::ptr::null;

    fn instantiated(token: &str, event_mode: bool, intermediate_count: usize) -> bool {
        let token = CString::new(token).unwrap();
        // SAFETY: the texts end in 0, and what was made is freed once.
        unsafe {
            let handle = fmi3InstantiateCoSimulation(
                c"fleet".as_ptr(),
                token.as_ptr(),
                null(),
                false,
                false,
                event_mode,
                false,
                null(),
                intermediate_count,
                null_mut(),
                None,
                None,
            );
            fmi3FreeInstance(handle);
            !handle.is_null()
        }
    }

    #[test]
    fn what_the_unit_does_not_offer_is_refused_at_the_start() {
        assert!(instantiated(&token(), false, 0));
        assert!(!instantiated("another", false, 0));
        assert!(!instantiated(&token(), true, 0));
        assert!(!instantiated(&token(), false, 1));
    }
}
