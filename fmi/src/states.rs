//! The functions that save, restore and serialise the state of an instance.

use std::ptr::null_mut;

use crate::error::Error;
use crate::handle::{Handle, Status, call, give, read, write};

/// The state of an instance behind the importer's pointer, in serialised form.
pub struct SavedState(Vec<u8>);

/// Saves the state. A state that is passed in is replaced.
///
/// # Safety
/// `state` points to null or to a state of this unit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(
    handle: *mut Handle,
    state: *mut *mut SavedState,
) -> Status {
    call(handle, |handle| {
        let slot = unsafe { state.as_mut() }.ok_or_else(|| Error::Null("FMUState".to_owned()))?;
        let saved = Box::new(SavedState(handle.instance.save()?));
        if !slot.is_null() {
            drop(unsafe { Box::from_raw(*slot) });
        }
        *slot = Box::into_raw(saved);
        Ok(())
    })
}

/// Restores a saved state.
///
/// # Safety
/// `state` is null or a state of this unit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(handle: *mut Handle, state: *const SavedState) -> Status {
    call(handle, |handle| {
        let saved = unsafe { state.as_ref() }.ok_or_else(|| Error::Null("FMUState".to_owned()))?;
        handle.instance = handle.instance.load(&saved.0)?;
        Ok(())
    })
}

/// Frees a saved state. Null is allowed and does nothing.
///
/// # Safety
/// `state` points to null or to a state of this unit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(
    handle: *mut Handle,
    state: *mut *mut SavedState,
) -> Status {
    call(handle, |_| {
        if let Some(slot) = unsafe { state.as_mut() }
            && !slot.is_null()
        {
            drop(unsafe { Box::from_raw(*slot) });
            *slot = null_mut();
        }
        Ok(())
    })
}

/// Writes the size of a serialised state in bytes.
///
/// # Safety
/// `state` is null or a state of this unit; `size` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(
    handle: *mut Handle,
    state: *const SavedState,
    size: *mut usize,
) -> Status {
    call(handle, |_| {
        let saved = unsafe { state.as_ref() }.ok_or_else(|| Error::Null("FMUState".to_owned()))?;
        unsafe { give(size, saved.0.len()) };
        Ok(())
    })
}

/// Serialises a state.
///
/// # Safety
/// `state` is null or a state of this unit; `bytes` is null or has the given length.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    handle: *mut Handle,
    state: *const SavedState,
    bytes: *mut u8,
    size: usize,
) -> Status {
    call(handle, |_| {
        let saved = unsafe { state.as_ref() }.ok_or_else(|| Error::Null("FMUState".to_owned()))?;
        let out = unsafe { write(bytes, size, "serializedState") }?;
        if out.len() != saved.0.len() {
            return Err(Error::Argument {
                argument: "size",
                value: size.to_string(),
                allowed: format!("this state has {} bytes", saved.0.len()),
            });
        }
        out.copy_from_slice(&saved.0);
        Ok(())
    })
}

/// Deserialises a state, after a check of all its bytes.
///
/// # Safety
/// `bytes` is null or has the given length; `state` points to null or to a state of this unit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    handle: *mut Handle,
    bytes: *const u8,
    size: usize,
    state: *mut *mut SavedState,
) -> Status {
    call(handle, |handle| {
        let slot = unsafe { state.as_mut() }.ok_or_else(|| Error::Null("FMUState".to_owned()))?;
        let bytes = unsafe { read(bytes, size, "serializedState") }?;
        handle.instance.load(bytes)?;
        if !slot.is_null() {
            drop(unsafe { Box::from_raw(*slot) });
        }
        *slot = Box::into_raw(Box::new(SavedState(bytes.to_vec())));
        Ok(())
    })
}
