//! Lists of names as static C strings.

use std::ffi::c_char;
use std::ptr;

/// Returns the number of bytes of [`joined`] for a list of names.
pub(crate) const fn joined_len(names: &[&str]) -> usize {
    let (mut len, mut index) = (0, 0);
    while index < names.len() {
        len += names[index].len() + 1;
        index += 1;
    }
    len
}

/// Returns the names one after the other, each with a terminating zero.
pub(crate) const fn joined<const LEN: usize>(names: &[&str]) -> [u8; LEN] {
    let mut bytes = [0; LEN];
    let (mut at, mut index) = (0, 0);
    while index < names.len() {
        let name = names[index].as_bytes();
        let (_, rest) = bytes.split_at_mut(at);
        rest.split_at_mut(name.len()).0.copy_from_slice(name);
        at += name.len() + 1;
        index += 1;
    }
    bytes
}

/// Returns a name of [`joined`] as a C string, or NULL for an index beyond the last name.
pub(crate) fn name_at(joined: &'static [u8], index: u32) -> *const c_char {
    let name = joined
        .split_inclusive(|&byte| byte == 0)
        .nth(index as usize);
    name.map_or(ptr::null(), |name| name.as_ptr().cast())
}

#[cfg(test)]
mod tests {
    use std::ffi::CStr;

    use jcas_core::observation::fields::FIELD_NAMES;
    use jcas_core::reward;

    use crate::{jcas_observation_field_name, jcas_reward_name};

    #[test]
    fn names_are_the_kernels() {
        let named = |name: extern "C" fn(u32) -> *const std::ffi::c_char, names: &[&str]| {
            for (index, kernel) in (0..).zip(names) {
                // SAFETY: the text is a static C string.
                let given = unsafe { CStr::from_ptr(name(index)) };
                assert_eq!(given.to_str(), Ok(*kernel));
            }
            assert!(name(names.len() as u32).is_null());
        };
        named(jcas_observation_field_name, &FIELD_NAMES);
        named(jcas_reward_name, &reward::NAMES);
    }
}
