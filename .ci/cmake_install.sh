#!/usr/bin/env bash
# Installs the library with CMake and prints where. Other sections share the release build.
set -euo pipefail

prefix=$CARGO_TARGET_DIR/installed/cmake
cmake -B "$CARGO_TARGET_DIR/cmake" -DCMAKE_INSTALL_PREFIX="$prefix" -DJCAS_CARGO_PROFILE=release \
    -DJCAS_CARGO_TARGET_DIR="$CARGO_TARGET_DIR" >/dev/null
cmake --build "$CARGO_TARGET_DIR/cmake" >/dev/null
cmake --install "$CARGO_TARGET_DIR/cmake" >/dev/null
echo "$prefix"
