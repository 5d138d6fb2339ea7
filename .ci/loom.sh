#!/usr/bin/env bash
# The thread pool of a batch and the mark of an object in use, under loom. It runs all interleavings
# of two and three threads, and bounds them where there are too many. Another cfg builds other code,
# so that it has a target folder of its own.
set -euo pipefail

export RUSTFLAGS="--cfg loom" CARGO_TARGET_DIR=$CARGO_TARGET_DIR/loom
cargo test --locked --release --package jcas-ffi --lib model_check
