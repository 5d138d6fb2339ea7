#!/usr/bin/env bash
# The golden traces on s390x, which is big endian, and on ARMv7, run under QEMU. Debian's compiler
# builds std for both, since the other architectures' packages of it lag behind the compiler.
set -euo pipefail

export RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1
export CARGO_TARGET_S390X_UNKNOWN_LINUX_GNU_LINKER=s390x-linux-gnu-gcc
export CARGO_TARGET_S390X_UNKNOWN_LINUX_GNU_RUNNER="qemu-s390x -L /usr/s390x-linux-gnu"
export CARGO_TARGET_ARMV7_UNKNOWN_LINUX_GNUEABIHF_LINKER=arm-linux-gnueabihf-gcc
export CARGO_TARGET_ARMV7_UNKNOWN_LINUX_GNUEABIHF_RUNNER="qemu-arm -L /usr/arm-linux-gnueabihf"

"$RUSTC" --version
for target in s390x-unknown-linux-gnu armv7-unknown-linux-gnueabihf; do
    cargo run --locked --quiet --release --target "$target" -Zbuild-std=std,panic_abort \
        --manifest-path tests/portable/Cargo.toml
done
