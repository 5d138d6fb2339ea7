#!/usr/bin/env bash
# A golden trace on a Cortex-M4 without an operating system, from static memory, under QEMU.
# Debian's compiler builds `core` from its source, which cargo calls an unstable feature.
set -euo pipefail

export RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1
export CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER=arm-linux-gnueabihf-ld
export CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUSTFLAGS="-C linker-flavor=ld -C link-arg=-Tlink.x"
export CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUNNER="qemu-system-arm -machine mps2-an386 -nographic \
    -semihosting-config enable=on,target=native -kernel"

cargo run --locked --quiet --release --target thumbv7em-none-eabihf -Zbuild-std=core \
    --manifest-path tests/cortex_m/Cargo.toml

echo "the policies compile for it, too"
cargo build --locked --quiet --release --target thumbv7em-none-eabihf -Zbuild-std=core \
    --package jcas-policy
