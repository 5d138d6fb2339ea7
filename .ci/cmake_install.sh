#!/usr/bin/env bash
# Installs the library with CMake and prints where.
set -euo pipefail

prefix=$CARGO_TARGET_DIR/installed/cmake
cmake -B "$CARGO_TARGET_DIR/cmake" -DCMAKE_INSTALL_PREFIX="$prefix" >&2
cmake --build "$CARGO_TARGET_DIR/cmake" >&2
cmake --install "$CARGO_TARGET_DIR/cmake" >&2
echo "$prefix"
