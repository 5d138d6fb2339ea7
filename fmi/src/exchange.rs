//! The functions that get and set variables.

use std::ffi::{CStr, CString, c_char};

use crate::error::Error;
use crate::handle::{Handle, Status, call, read, write};
use crate::values::Values;

/// Gets variables of one type into one array.
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
            let found = of(handle.instance.get(vr)?).ok_or(Error::OtherType(vr))?;
            row.extend(found);
        }
        if row.len() != length {
            let needed = row.len();
            return Err(Error::Length {
                given: length,
                needed,
            });
        }
        out.clone_from_slice(&row);
        Ok(())
    })
}

/// Sets variables of one type from one array.
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
            let (mine, after) = rest
                .split_at_checked(elements)
                .ok_or_else(|| Error::Argument {
                    argument: "nValues",
                    value: length.to_string(),
                    allowed: format!("value reference {vr} has {elements}"),
                })?;
            let values = of(mine);
            if values.kind() != kind {
                return Err(Error::OtherType(vr));
            }
            changes.push((vr, values));
            rest = after;
        }
        if !rest.is_empty() {
            let needed = length - rest.len();
            return Err(Error::Length {
                given: length,
                needed,
            });
        }
        for (vr, values) in changes {
            handle.instance.set(vr, values)?;
        }
        Ok(())
    })
}

macro_rules! numbers {
    ($($getter:ident, $setter:ident, $type:ty, $kind:ident;)+) => { $(
        /// Gets variables of this type.
        ///
        /// # Safety
        /// The arrays are null or have the given lengths.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $getter(
            handle: *mut Handle,
            references: *const u32,
            count: usize,
            values: *mut $type,
            length: usize,
        ) -> Status {
            let of_kind = |values| match values {
                Values::$kind(values) => Some(values),
                _ => None,
            };
            unsafe { get(handle, references, count, values, length, of_kind) }
        }
        /// Sets variables of this type.
        ///
        /// # Safety
        /// The arrays are null or have the given lengths.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $setter(
            handle: *mut Handle,
            references: *const u32,
            count: usize,
            values: *const $type,
            length: usize,
        ) -> Status {
            let of_kind = |values: &[$type]| Values::$kind(values.to_vec());
            unsafe { set(handle, references, count, values, length, of_kind) }
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

/// Gets texts. They are valid until the next call on the instance.
///
/// # Safety
/// The arrays are null or have the given lengths.
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
                return Err(Error::OtherType(vr));
            };
            for text in found {
                texts.push(CString::new(text)?);
            }
        }
        if texts.len() != length {
            let needed = texts.len();
            return Err(Error::Length {
                given: length,
                needed,
            });
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
/// The arrays are null or have the given lengths; the texts end in 0.
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
            return Err(Error::Length {
                given: length,
                needed: count,
            });
        }
        for (&vr, &text) in references.iter().zip(values) {
            if text.is_null() {
                return Err(Error::Null(format!("the text for value reference {vr}")));
            }
            // The text is not null and ends in 0 by the standard.
            let text = unsafe { CStr::from_ptr(text) }.to_str()?;
            let values = Values::String(vec![text.to_owned()]);
            if handle.instance.shape(vr)?.0 != values.kind() {
                return Err(Error::OtherType(vr));
            }
            handle.instance.set(vr, values)?;
        }
        Ok(())
    })
}
