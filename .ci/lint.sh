#!/usr/bin/env bash
# Formatting and clippy, over everything, with warnings as errors.
set -euo pipefail

cargo fmt --all --check
for crate in no_std portable; do
    cargo fmt --check --manifest-path tests/$crate/Cargo.toml
done
cargo clippy --locked --quiet --workspace --all-targets -- -D warnings
