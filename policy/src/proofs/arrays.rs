//! P11: no array reaches out of its file.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::network::place;

/// An array is either refused, or lies within the data and is exactly as long as its elements.
fn lies_within_the_data(offsets: [usize; 2], elements: usize, width: usize, data_len: usize) {
    if let Ok(range) = place(offsets, elements, width, data_len) {
        assert!(range.start <= range.end && range.end <= data_len);
        assert!(elements <= data_len && range.end - range.start == elements * width);
    }
}

#[cfg_attr(kani, kani::proof)]
pub fn arrays_lie_within_the_data() {
    // Near misses as likely as not.
    let data_len: usize = if kani::any() {
        between(0, 64) as usize
    } else {
        kani::any()
    };
    let start: usize = if kani::any() {
        between(0, 64) as usize
    } else {
        kani::any()
    };
    let end: usize = if kani::any() {
        between(0, 64) as usize
    } else {
        kani::any()
    };
    let elements: usize = if kani::any() {
        between(0, 16) as usize
    } else {
        kani::any()
    };
    let width = if kani::any() { 2 } else { 4 };
    let accepted = place([start, end], elements, width, data_len).is_ok();
    // This has no branch: an optimized build makes two covers of one that has any.
    kani::cover!(accepted & (elements > 0), "an array is read");
    kani::cover!(
        !accepted & (start <= end) & (end <= data_len),
        "a wrong length is refused"
    );
    lies_within_the_data([start, end], elements, width, data_len);
}

#[cfg(not(kani))]
super::standin::twins! {
    arrays_lie_within_the_data: 4000 cases, 2 covers;
}
