#!/usr/bin/env bash
# Every Rust test but training's, in a debug build: overflow checks and debug assertions on.
set -euo pipefail

cargo test --locked --workspace --exclude jcas-train --exclude jcas-reproduce
