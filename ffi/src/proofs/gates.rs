//! Proofs of P12: a gate returns exactly the promised memory, or a status and no access to memory.

use std::ffi::c_char;
use std::ptr::null_mut;

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::handle::check;
use crate::memory::{message, output, record, text_out};
use crate::records::jcas_outcome;
use crate::sim_block::SimBlock;
use crate::status::{
    Fault, JCAS_ERROR_ALIGNMENT, JCAS_ERROR_HANDLE, JCAS_ERROR_LENGTH, JCAS_ERROR_NULL,
    JCAS_ERROR_STRUCT_SIZE, JCAS_OK, jcas_status_string,
};
use crate::version::{JCAS_ABI_VERSION, jcas_abi_check};

/// Returns null, a misaligned pointer or the pointer itself.
fn any_pointer<T>(to: *mut T) -> *mut T {
    match between(0, 2) {
        0 => null_mut(),
        1 => to.cast::<u8>().wrapping_add(1).cast(),
        _ => to,
    }
}

/// Returns the refusal that a pointer from [`any_pointer`] requires.
fn expected_fault<T>(given: *mut T, to: *mut T) -> Option<Fault> {
    if given.is_null() {
        Some(Fault::Status(JCAS_ERROR_NULL))
    } else if given != to {
        Some(Fault::Status(JCAS_ERROR_ALIGNMENT))
    } else {
        None
    }
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(10))]
pub fn a_buffer_is_given_out_whole_or_not_at_all() {
    let mut memory = [7u32; 8];
    let to = memory.as_mut_ptr();
    let pointer = any_pointer(to);
    let (count, expected) = (between(0, 9) as usize, between(0, 8) as usize);
    kani::cover!(pointer.is_null(), "null");
    kani::cover!(!pointer.is_null() && pointer != to, "misaligned");
    kani::cover!(pointer == to && count != expected, "another length");
    // SAFETY: `count` equals `expected`, at most 8, whenever the memory is touched.
    match unsafe { output(pointer, count, expected) } {
        Ok(buffer) => {
            assert!(pointer == to && count == expected && buffer.len() == expected);
            if let Some(last) = buffer.last_mut() {
                *last = 9;
            }
            assert!(expected == 0 || memory[expected - 1] == 9);
        }
        Err(fault) => {
            let because = expected_fault(pointer, to);
            let status = because.map_or(JCAS_ERROR_LENGTH, |fault| fault.status());
            assert!(fault.status() == status);
            assert!(memory[between(0, 7) as usize] == 7);
        }
    }
}

#[cfg_attr(kani, kani::proof)]
pub fn a_record_of_another_size_is_not_touched() {
    let size = size_of::<jcas_outcome>() as u32;
    let mut outcome = any_outcome();
    let to = &raw mut outcome;
    let pointer = any_pointer(to);
    let named = outcome.struct_size;
    kani::cover!(pointer == to && named == size, "the right size");
    kani::cover!(pointer == to && named > size, "a later library's size");
    // SAFETY: null, misaligned, or a record whose first field can be read.
    match unsafe { record(pointer) } {
        Ok(place) => {
            assert!(pointer == to && named == size);
            place.put(jcas_outcome {
                struct_size: size,
                reward: 2.5,
                ..outcome
            });
            assert!(outcome.reward == 2.5);
        }
        Err(fault) => {
            let because = expected_fault(pointer, to);
            assert!(fault == because.unwrap_or(Fault::Status(JCAS_ERROR_STRUCT_SIZE)));
            assert!(outcome.struct_size == named && outcome.reward == 1.5);
        }
    }
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(10))]
pub fn a_text_fits_its_buffer_or_is_not_written() {
    const TEXT: &str = "jcas";
    let mut buffer = [1 as c_char; 8];
    let mut length = 99usize;
    let start = buffer.as_mut_ptr();
    let text: *mut c_char = if kani::any() { start } else { null_mut() };
    let capacity = between(0, 8) as usize;
    let out: *mut usize = if kani::any() {
        &raw mut length
    } else {
        null_mut()
    };
    let has_out = !out.is_null();
    kani::cover!(
        !text.is_null() && capacity == TEXT.len() + 1,
        "fits exactly"
    );
    kani::cover!(!text.is_null() && capacity == TEXT.len(), "one byte short");
    kani::cover!(text.is_null() && capacity == 0, "asks for the length");
    // SAFETY: null, or 8 bytes of which at most `capacity` are written; null, or a usize.
    let done = unsafe { text_out(TEXT, text, capacity, out) };
    let fits = if text.is_null() {
        capacity == 0
    } else {
        capacity > TEXT.len()
    };
    assert!(done.is_ok() == (has_out && fits));
    let written = done.is_ok() && !text.is_null();
    let told = has_out && (!text.is_null() || capacity == 0);
    assert!(length == if told { TEXT.len() } else { 99 });
    assert!(buffer[0] == if written { b'j' as c_char } else { 1 });
    assert!(buffer[4] == if written { 0 } else { 1 });
    assert!(buffer[5] == 1);
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(10))]
pub fn a_message_is_cut_to_its_buffer() {
    // Each letter has two bytes, and truncation may not split it.
    const TEXT: &str = "θρ";
    let mut buffer = [1 as c_char; 8];
    let capacity = between(0, 8) as usize;
    kani::cover!(capacity == 0, "no room");
    kani::cover!(capacity == 4, "room for three bytes of four");
    // SAFETY: `capacity` bytes can be written.
    unsafe { message(TEXT, buffer.as_mut_ptr(), capacity) };
    let kept = match capacity {
        0..=2 => 0,
        3..=4 => 2,
        _ => 4,
    };
    assert!(buffer[kept] == if capacity == 0 { 1 } else { 0 });
    assert!(kept == 0 || buffer[0] == TEXT.as_bytes()[0] as c_char);
    let beyond = between(0, 7) as usize;
    assert!(beyond < capacity || buffer[beyond] == 1);
}

#[cfg_attr(kani, kani::proof)]
pub fn a_handle_is_known_by_its_seal() {
    let mut block = [0u64; 2];
    let at = block.as_mut_ptr().cast::<SimBlock>();
    let sealed = <SimBlock as crate::handle::Block>::seal(at);
    block[0] = if kani::any() { sealed } else { kani::any() };
    let pointer = any_pointer(at);
    kani::cover!(pointer == at && block[0] == sealed, "a seal");
    kani::cover!(pointer == at && block[0] != sealed, "no seal");
    // SAFETY: null, misaligned, or eight bytes that can be read; no block is opened.
    let verdict = unsafe { check(pointer.cast_const()) };
    match (expected_fault(pointer, at), block[0] == sealed) {
        (Some(fault), _) => assert!(verdict == Err(fault)),
        (None, true) => assert!(verdict == Ok(())),
        (None, false) => assert!(verdict == Err(Fault::Status(JCAS_ERROR_HANDLE))),
    }
}

#[cfg_attr(kani, kani::proof)]
pub fn a_later_interface_is_refused() {
    let near = between(0, 2) << 24 | between(0, 2) << 16 | between(0, 2);
    let header: u32 = if kani::any() {
        kani::any()
    } else {
        near as u32
    };
    let served = jcas_abi_check(header) == JCAS_OK;
    kani::cover!(served, "the same interface");
    kani::cover!(!served, "another one");
    let (major, minor) = (header >> 24, header & 0xFF_FFFF);
    let (our_major, our_minor) = (JCAS_ABI_VERSION >> 24, JCAS_ABI_VERSION & 0xFF_FFFF);
    assert!(served == (major == our_major && minor <= our_minor));
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(64))]
pub fn every_status_has_words() {
    let status: i32 = if kani::any() {
        kani::any()
    } else {
        -(between(0, 31) as i32)
    };
    let words = jcas_status_string(status);
    kani::cover!(status == JCAS_OK, "success");
    kani::cover!(status > 0, "no status");
    assert!(!words.is_null());
    let mut length = 0;
    // SAFETY: a static C string: every byte up to the first zero can be read.
    while length < 62 && unsafe { words.wrapping_add(length).read() } != 0 {
        length += 1;
    }
    assert!(length > 0 && length < 62);
}

fn any_outcome() -> jcas_outcome {
    let size = size_of::<jcas_outcome>() as u32;
    let struct_size = if kani::any() { kani::any() } else { size };
    jcas_outcome {
        struct_size,
        terminated: 0,
        truncated: 0,
        false_confirmations: 0,
        reward: 1.5,
    }
}

#[cfg(not(kani))]
super::standin::twins! {
    a_buffer_is_given_out_whole_or_not_at_all: 2000 cases, 3 covers;
    a_record_of_another_size_is_not_touched: 1000 cases, 2 covers;
    a_text_fits_its_buffer_or_is_not_written: 2000 cases, 3 covers;
    a_message_is_cut_to_its_buffer: 1000 cases, 2 covers;
    a_handle_is_known_by_its_seal: 1000 cases, 2 covers;
    a_later_interface_is_refused: 1000 cases, 2 covers;
    every_status_has_words: 1000 cases, 2 covers;
}

#[cfg(test)]
mod statuses {
    use super::*;
    use std::collections::BTreeSet;
    use std::ffi::CStr;

    /// Catches a status of the header without a text of its own.
    #[test]
    fn each_status_of_the_header_has_words_of_its_own() {
        let words = |status: i32| {
            // SAFETY: the text is a static C string.
            unsafe { CStr::from_ptr(jcas_status_string(status)) }
        };
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../include/jcas.h");
        let header = std::fs::read_to_string(path).unwrap();
        let numbers: BTreeSet<i32> = header
            .lines()
            .filter_map(|line| line.strip_prefix("#define JCAS_ERROR_")?.split_once(" ("))
            .map(|(_, number)| number.trim_end_matches(')').parse().unwrap())
            .collect();
        let texts: BTreeSet<&CStr> = numbers.iter().map(|&status| words(status)).collect();
        assert!(numbers.len() > 17);
        assert_eq!(texts.len(), numbers.len());
        assert!(!texts.contains(words(1)) && !texts.contains(words(JCAS_OK)));
    }
}
