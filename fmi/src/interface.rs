//! The functions of FMI 3.0 for Co-Simulation.
//!
//! Every pointer is checked for null before it is read; lengths are the importer's word. No panic crosses: a
//! caught one is `fmi3Fatal`. What the unit does not offer (Model Exchange, Scheduled Execution, clocks,
//! derivatives) answers `fmi3Error`, with a message.

use std::ffi::{CStr, CString, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::ptr::null_mut;
use std::slice;

use crate::description::token;
use crate::instance::{Instance, Mode, Values};

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
    instance: Instance,
    log: LogMessage,
    logging: bool,
    environment: *mut c_void,
    /// Texts that were handed out last; the standard lets them live until the next call.
    texts: Vec<CString>,
}

impl Handle {
    fn say(&self, status: Status, message: &str) {
        let Some(log) = self.log else { return };
        if !self.logging {
            return;
        }
        let text = CString::new(message.replace('\0', " ")).unwrap_or_default();
        // The importer's own function, with its own environment and two texts that outlive the call.
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
unsafe fn read<'a, T>(pointer: *const T, count: usize, what: &str) -> Result<&'a [T], String> {
    if count == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() {
        return Err(format!("{what} is null"));
    }
    // Not null; `count` elements by the importer's word.
    Ok(unsafe { slice::from_raw_parts(pointer, count) })
}

unsafe fn write<'a, T>(pointer: *mut T, count: usize, what: &str) -> Result<&'a mut [T], String> {
    if count == 0 {
        return Ok(&mut []);
    }
    if pointer.is_null() {
        return Err(format!("{what} is null"));
    }
    // As above, and not shared while the call lasts.
    Ok(unsafe { slice::from_raw_parts_mut(pointer, count) })
}

unsafe fn give<T>(pointer: *mut T, value: T) {
    if !pointer.is_null() {
        // Not null; one element by the standard.
        unsafe { pointer.write(value) }
    }
}

/// The version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// Turns messages on or off; there is one category.
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

/// An instance, or null: where the token is that of another description, or event mode is asked for.
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
    _event_mode: bool,
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
        // A text of the importer's.
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
    // A text of the importer's.
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
    if intermediate_count > 0 {
        handle.say(Status::Error, "there are no intermediate updates");
        return null_mut();
    }
    Box::into_raw(Box::new(handle))
}

/// Ends an instance; null is nothing.
///
/// # Safety
/// `handle` is null, or was returned by instantiation and not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(handle: *mut Handle) {
    if !handle.is_null() {
        // From Box::into_raw, once.
        drop(unsafe { Box::from_raw(handle) });
    }
}

/// Parameters may be set from here on.
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
            return Err(format!("startTime = {start}: must be a finite number"));
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

/// The mission stands at its start.
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

/// Sizes may be set from here on.
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

/// Sizes are settled.
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

/// No more steps.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3Terminate(handle: *mut Handle) -> Status {
    call(handle, |handle| {
        handle
            .instance
            .go(&[Mode::Step], Mode::Terminated, "fmi3Terminate")
    })
}

/// As just instantiated.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3Reset(handle: *mut Handle) -> Status {
    call(handle, |handle| handle.instance.reset())
}

/// Whole steps of the mission.
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

/// Gets all of the variables of one type into one row.
unsafe fn get<T: Clone>(
    handle: *mut Handle,
    references: *const u32,
    count: usize,
    values: *mut T,
    length: usize,
    of: impl Fn(Values) -> Option<Vec<T>>,
) -> Status {
    call(handle, |handle| {
        let references = unsafe { read(references, count, "valueReferences") }?;
        let out = unsafe { write(values, length, "values") }?;
        let mut row = Vec::with_capacity(length);
        for &vr in references {
            let found = of(handle.instance.get(vr)?)
                .ok_or_else(|| format!("value reference {vr} is of another type"))?;
            row.extend(found);
        }
        if row.len() != length {
            return Err(format!(
                "nValues = {length}: these variables have {}",
                row.len()
            ));
        }
        out.clone_from_slice(&row);
        Ok(())
    })
}

/// Sets all of the variables of one type from one row.
unsafe fn set<T: Clone>(
    handle: *mut Handle,
    references: *const u32,
    count: usize,
    values: *const T,
    length: usize,
    of: impl Fn(&[T]) -> Values,
) -> Status {
    call(handle, |handle| {
        let references = unsafe { read(references, count, "valueReferences") }?;
        let mut rest = unsafe { read(values, length, "values") }?;
        let mut changes = Vec::with_capacity(count);
        for &vr in references {
            let (kind, elements) = handle.instance.shape(vr)?;
            let (mine, after) = rest.split_at_checked(elements).ok_or_else(|| {
                format!("nValues = {length}: value reference {vr} has {elements}")
            })?;
            let values = of(mine);
            if values.kind() != kind {
                return Err(format!("value reference {vr} is of another type"));
            }
            changes.push((vr, values));
            rest = after;
        }
        if !rest.is_empty() {
            return Err(format!(
                "nValues = {length}: these variables have {}",
                length - rest.len()
            ));
        }
        for (vr, values) in changes {
            handle.instance.set(vr, values)?;
        }
        Ok(())
    })
}

macro_rules! numbers {
    ($($getter:ident, $setter:ident, $type:ty, $kind:ident;)+) => { $(
        /// Values of variables of this type.
        ///
        /// # Safety
        /// The arrays are null or as long as said.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $getter(handle: *mut Handle, references: *const u32, count: usize, values: *mut $type, length: usize) -> Status {
            unsafe { get(handle, references, count, values, length, |values| match values { Values::$kind(values) => Some(values), _ => None }) }
        }
        /// Sets variables of this type.
        ///
        /// # Safety
        /// The arrays are null or as long as said.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $setter(handle: *mut Handle, references: *const u32, count: usize, values: *const $type, length: usize) -> Status {
            unsafe { set(handle, references, count, values, length, |values| Values::$kind(values.to_vec())) }
        }
    )+ };
}

numbers! {
    fmi3GetFloat32, fmi3SetFloat32, f32, Float32;
    fmi3GetFloat64, fmi3SetFloat64, f64, Float64;
    fmi3GetUInt32, fmi3SetUInt32, u32, UInt32;
    fmi3GetUInt64, fmi3SetUInt64, u64, UInt64;
    fmi3GetBoolean, fmi3SetBoolean, bool, Boolean;
}

/// Texts; they live until the next call on the instance.
///
/// # Safety
/// The arrays are null or as long as said.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetString(
    handle: *mut Handle,
    references: *const u32,
    count: usize,
    values: *mut *const c_char,
    length: usize,
) -> Status {
    call(handle, |handle| {
        let references = unsafe { read(references, count, "valueReferences") }?;
        let out = unsafe { write(values, length, "values") }?;
        let mut texts = Vec::with_capacity(length);
        for &vr in references {
            let Values::String(found) = handle.instance.get(vr)? else {
                return Err(format!("value reference {vr} is of another type"));
            };
            for text in found {
                texts.push(CString::new(text).map_err(|error| error.to_string())?);
            }
        }
        if texts.len() != length {
            return Err(format!(
                "nValues = {length}: these variables have {}",
                texts.len()
            ));
        }
        handle.texts = texts;
        for (slot, text) in out.iter_mut().zip(&handle.texts) {
            *slot = text.as_ptr();
        }
        Ok(())
    })
}

/// Sets texts.
///
/// # Safety
/// The arrays are null or as long as said; the texts end in 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetString(
    handle: *mut Handle,
    references: *const u32,
    count: usize,
    values: *const *const c_char,
    length: usize,
) -> Status {
    call(handle, |handle| {
        let references = unsafe { read(references, count, "valueReferences") }?;
        let values = unsafe { read(values, length, "values") }?;
        if count != length {
            return Err(format!("nValues = {length}: these variables have {count}"));
        }
        for (&vr, &text) in references.iter().zip(values) {
            if text.is_null() {
                return Err(format!("the text for value reference {vr} is null"));
            }
            // Not null; ends in 0 by the standard.
            let text = unsafe { CStr::from_ptr(text) }
                .to_str()
                .map_err(|error| error.to_string())?;
            let values = Values::String(vec![text.to_owned()]);
            if handle.instance.shape(vr)?.0 != values.kind() {
                return Err(format!("value reference {vr} is of another type"));
            }
            handle.instance.set(vr, values)?;
        }
        Ok(())
    })
}

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
