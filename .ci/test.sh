#!/usr/bin/env bash
# Every Rust test in a debug build: overflow checks and debug assertions on. It needs no root and
# installs nothing.
set -euo pipefail

cargo test --locked --workspace
