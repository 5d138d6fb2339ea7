#!/usr/bin/env bash
# Formatting, clippy and rustdoc, over everything, with warnings as errors.
set -euo pipefail

cargo fmt --all --check
for crate in api cortex_m no_std portable; do
    cargo fmt --check --manifest-path tests/$crate/Cargo.toml
done
cargo clippy --locked --quiet --workspace --all-targets -- -D warnings
RUSTDOCFLAGS="-D warnings" cargo doc --locked --quiet --workspace --no-deps

# Columns, long functions and sentences, words, dead files, tables, names of types, subjects of
# commits.
cargo run --locked --quiet --package xtask -- tidy
