#!/usr/bin/env bash
# The library, installed as C people install it and used from an outside folder, shared and static:
# by cargo-c with its pkg-config file, and by CMake.
set -euo pipefail

# Rust's newest cargo-c wants a newer compiler. Unoptimised it builds in a third of the time.
readonly CARGO_C=0.10.24
tools=$CARGO_TARGET_DIR/tools
if [[ $("$tools/bin/cargo-cinstall" --version 2>/dev/null) != *" $CARGO_C+"* ]]; then
    CARGO_PROFILE_DEV_DEBUG=0 CARGO_TARGET_DIR=$tools/build \
        cargo install --quiet --locked --debug --root "$tools" cargo-c@$CARGO_C
fi
