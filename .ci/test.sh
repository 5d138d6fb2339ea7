#!/usr/bin/env bash
# Every Rust test in a debug build: overflow checks and debug assertions on. No root, nothing to install.
set -euo pipefail

cargo test --locked --workspace
