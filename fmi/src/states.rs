//! The functions that keep the state of an instance, go back to it and serialise it.

use std::ptr::null_mut;

use crate::handle::{Handle, Status, call, give, read, write};

/// The state of an instance as the importer holds it: the bytes that it is serialised to.
pub struct SavedState(Vec<u8>);

/// Keeps the state. A state that is passed in is replaced.
///
/// # Safety
/// `state` points to null or to a state of this unit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(
    handle: *mut Handle,
    state: *mut *mut SavedState,
) -> Status {
    call(handle, |handle| {
        let slot = unsafe { state.as_mut() }.ok_or("FMUState is null")?;
        let saved = Box::new(SavedState(handle.instance.save()?));
        if !slot.is_null() {
            drop(unsafe { Box::from_raw(*slot) });
        }
        *slot = Box::into_raw(saved);
        Ok(())
    })
}

/// Goes back to a state that was kept.
///
/// # Safety
/// `state` is null or a state of this unit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(handle: *mut Handle, state: *const SavedState) -> Status {
    call(handle, |handle| {
        let saved = unsafe { state.as_ref() }.ok_or("FMUState is null")?;
        handle.instance = handle.instance.load(&saved.0)?;
        Ok(())
    })
}

/// Frees a state that was kept; null is nothing.
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

/// Bytes of a state.
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
        let saved = unsafe { state.as_ref() }.ok_or("FMUState is null")?;
        unsafe { give(size, saved.0.len()) };
        Ok(())
    })
}

/// Writes a state.
///
/// # Safety
/// `state` is null or a state of this unit; `bytes` is null or as long as said.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    handle: *mut Handle,
    state: *const SavedState,
    bytes: *mut u8,
    size: usize,
) -> Status {
    call(handle, |_| {
        let saved = unsafe { state.as_ref() }.ok_or("FMUState is null")?;
        let out = unsafe { write(bytes, size, "serializedState") }?;
        if out.len() != saved.0.len() {
            return Err(format!(
                "size = {size}: this state has {} bytes",
                saved.0.len()
            ));
        }
        out.copy_from_slice(&saved.0);
        Ok(())
    })
}

/// Reads a state; it is checked whole.
///
/// # Safety
/// `bytes` is null or as long as said; `state` points to null or to a state of this unit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    handle: *mut Handle,
    bytes: *const u8,
    size: usize,
    state: *mut *mut SavedState,
) -> Status {
    call(handle, |handle| {
        let slot = unsafe { state.as_mut() }.ok_or("FMUState is null")?;
        let bytes = unsafe { read(bytes, size, "serializedState") }?;
        handle.instance.load(bytes)?;
        if !slot.is_null() {
            drop(unsafe { Box::from_raw(*slot) });
        }
        *slot = Box::into_raw(Box::new(SavedState(bytes.to_vec())));
        Ok(())
    })
}
