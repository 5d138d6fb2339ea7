//! What the image and its stack take, from the symbols of the linker script.
//!
//! This file needs `unsafe` since it reads memory that belongs to no variable. The kernel has none.

use core::ptr;

/// What cortex-m-rt writes into the stack before the program begins.
const PAINT: u32 = 0xcccc_cccc;

unsafe extern "C" {
    static __sidata: u32;
    static __sdata: u32;
    static __edata: u32;
    static _stack_start: u32;
    static _stack_end: u32;
}

/// The most bytes that the stack has held.
pub fn stack_used() -> usize {
    let top = &raw const _stack_start as usize;
    let mut at = &raw const _stack_end;
    // SAFETY: the linker script reserves every word below the top for the stack.
    while (at as usize) < top && unsafe { ptr::read_volatile(at) } == PAINT {
        at = at.wrapping_add(1);
    }
    top - at as usize
}

/// The bytes of the image in flash: vectors, code, constants, and initial values of variables.
pub fn flash_used() -> usize {
    let [load, begin, end] =
        [&raw const __sidata, &raw const __sdata, &raw const __edata].map(|at| at as usize);
    // Flash begins at address 0, and the initial values are its last part.
    load + (end - begin)
}
