#!/usr/bin/env bash
# The laboratory, a workspace of its own: formatting, clippy, training and reproduction in a
# release build.
set -euo pipefail

cd lab
cargo fmt --all --check
cargo clippy --locked --quiet --release --workspace --all-targets -- -D warnings
cargo test --locked --release --workspace
