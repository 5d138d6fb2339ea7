#!/usr/bin/env bash
# The golden traces on AArch64: built by Debian's Rust compiler, run under QEMU.
set -euo pipefail

export RUSTC=/usr/bin/rustc
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="qemu-aarch64 -L /usr/aarch64-linux-gnu"

"$RUSTC" --version
cargo run --locked --quiet --release --target aarch64-unknown-linux-gnu \
    --manifest-path tests/portable/Cargo.toml
