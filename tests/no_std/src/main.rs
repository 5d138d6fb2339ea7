//! A program without an operating system's support: no std, no libc, no allocator, its own entry
//! point. It stands for a flight computer. Two system calls of x86-64 Linux print its result.
//!
//! This file needs `unsafe` since it plays the part of the machine. The kernel has none.
#![no_std]
#![no_main]

mod flight;
mod memory;

use core::arch::{asm, global_asm};
use core::panic::PanicInfo;

// The ABI requires an aligned stack at a function call; the system enters without a call.
global_asm!(
    ".globl _start",
    "_start:",
    "xor ebp, ebp",
    "and rsp, -16",
    "call {start}",
    "ud2",
    start = sym start,
);

extern "C" fn start() -> ! {
    match flight::fly() {
        Ok(hash) => {
            print_hex(hash);
            exit(0)
        }
        Err(_) => exit(1),
    }
}

fn print_hex(value: u64) {
    let mut line = *b"0x0000000000000000\n";
    for (digit, byte) in line[2..18].iter_mut().enumerate() {
        *byte = b"0123456789abcdef"[(value >> (60 - 4 * digit)) as usize & 15];
    }
    // SAFETY: write(1, line, len) only reads `line`; the kernel clobbers rcx and r11.
    unsafe {
        asm!("syscall", inlateout("rax") 1_u64 => _, in("rdi") 1, in("rsi") line.as_ptr(),
            in("rdx") line.len(), out("rcx") _, out("r11") _, options(nostack));
    }
}

fn exit(status: u64) -> ! {
    // SAFETY: exit_group does not return.
    unsafe { asm!("syscall", in("rax") 231_u64, in("rdi") status, options(noreturn, nostack)) }
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    exit(2)
}
