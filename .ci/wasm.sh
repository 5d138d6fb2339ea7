#!/usr/bin/env bash
# The golden traces on wasm32, under Node: a 32-bit target; and the playground's kernel. Debian has
# no ready-made std for it. So it is built from the source that Debian packages, which cargo calls
# an unstable feature.
set -euo pipefail

linker=$(rustc --print sysroot)/lib/rustlib/x86_64-unknown-linux-gnu/bin/rust-lld
export RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1
export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=$linker

cargo build --locked --quiet --release --lib --target wasm32-unknown-unknown \
    -Zbuild-std=std,panic_abort --manifest-path tests/portable/Cargo.toml
node tests/portable/run.mjs "$CARGO_TARGET_DIR/wasm32-unknown-unknown/release/jcas_portable.wasm"
cargo build --locked --quiet --release --lib --target wasm32-unknown-unknown \
    -Zbuild-std=std,panic_abort --package jcas-web
