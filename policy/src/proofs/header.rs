//! P11: a file's header is what its length says, and its numbers are what their digits say.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::network::{HEADER_MAX, split, with_digit};

/// The length of the longest file of the proof, in bytes: the length of the header, and eight more.
const BYTES: usize = 16;

/// A file is either refused, or its header has the stated length and the data are all that follows.
fn header_is_as_long_as_it_says(bytes: &[u8], length: u64) {
    match split(bytes) {
        Ok((header, data)) => {
            assert!(header.len() as u64 == length && length <= HEADER_MAX as u64);
            assert!(8 + header.len() + data.len() == bytes.len());
        }
        Err(_) => assert!(bytes.len() < 8 || length > bytes.len() as u64 - 8),
    }
}

#[cfg_attr(kani, kani::proof)]
pub fn a_header_is_as_long_as_it_says() {
    let count = between(0, BYTES as u64) as usize;
    let length = if kani::any() {
        between(0, 9)
    } else {
        kani::any()
    };
    let mut file = [0; BYTES];
    file[..8].copy_from_slice(&length.to_le_bytes());
    let bytes = &file[..count];
    kani::cover!(
        split(bytes).is_ok_and(|(header, data)| !header.is_empty() && !data.is_empty()),
        "both parts"
    );
    kani::cover!(
        count >= 8 && split(bytes).is_err(),
        "a header that does not end"
    );
    header_is_as_long_as_it_says(bytes, length);
}

/// The result is exactly the number of the digits, or `None` if a usize cannot hold it.
fn digits_add_up(number: usize, digit: u8) {
    let exact = number as u128 * 10 + u128::from(digit);
    match with_digit(number, digit) {
        Some(longer) => assert!(longer as u128 == exact),
        None => assert!(exact > usize::MAX as u128),
    }
}

#[cfg_attr(kani, kani::proof)]
pub fn a_number_is_what_its_digits_say() {
    let number = if kani::any() {
        usize::MAX / 10
    } else {
        kani::any()
    };
    let digit = between(0, 9) as u8;
    let read = with_digit(number, digit);
    kani::cover!(
        read.is_some_and(|longer| longer > number),
        "a longer number"
    );
    kani::cover!(read.is_none(), "a number that is too large");
    digits_add_up(number, digit);
}

#[cfg(not(kani))]
super::standin::twins! {
    a_header_is_as_long_as_it_says: 4000 cases, 2 covers;
    a_number_is_what_its_digits_say: 4000 cases, 2 covers;
}
