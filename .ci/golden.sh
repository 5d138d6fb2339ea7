#!/usr/bin/env bash
# The golden traces in a release build; the debug build has them among its tests.
set -euo pipefail

cargo run --locked --quiet --release --manifest-path tests/portable/Cargo.toml
