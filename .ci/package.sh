#!/usr/bin/env bash
# The library, installed as C programmers do it and used from an outside folder, shared and static.
# It is installed by cargo-c with its pkg-config file, and by CMake. It is also built by CMake as a
# part of another project.
set -euo pipefail
shopt -s inherit_errexit

# Rust's newest cargo-c wants a newer compiler. Unoptimised it builds in a third of the time; its
# 345 crates are kept beyond this clone.
readonly CARGO_C=0.10.24
tools=${XDG_CACHE_HOME:-$HOME/.cache}/jcas/cargo-c-$CARGO_C
if [[ ! -x $tools/bin/cargo-cinstall ]]; then
    echo "building cargo-c $CARGO_C into $tools"
    CARGO_PROFILE_DEV_DEBUG=0 CARGO_TARGET_DIR=$CARGO_TARGET_DIR/cargo-c \
        cargo install --quiet --locked --debug --root "$tools" cargo-c@$CARGO_C
fi

prefix=$CARGO_TARGET_DIR/installed/cargo-c
echo "cargo-c"
PATH=$tools/bin:$PATH cargo cinstall --locked --profile dist --package jcas-ffi \
    --prefix="$prefix" --libdir=lib
tests/package/use.sh pkg-config "$prefix"

echo "the documents' programs against that installation"
.ci/snippets.sh "$prefix"

echo "CMake, installed"
installed=$(.ci/cmake_install.sh)
tests/package/use.sh cmake "$installed"
tests/package/use.sh pkg-config "$installed"

echo "CMake, add_subdirectory"
tests/package/use.sh subdirectory
