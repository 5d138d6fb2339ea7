#!/usr/bin/env bash
# The laboratory, a workspace of its own: formatting, clippy, rustdoc, training and reproduction in
# a release build.
set -euo pipefail

cd lab
cargo fmt --all --check
cargo clippy --locked --quiet --release --workspace --all-targets -- -D warnings
RUSTDOCFLAGS="-D warnings" cargo doc --locked --quiet --release --workspace --no-deps
cargo test --locked --release --workspace
