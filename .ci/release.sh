#!/usr/bin/env bash
# The release build: the golden traces, which the debug build has passed as well, and training with the tests that a
# debug build leaves out because it would take too long.
set -euo pipefail

# In one command, so that everything is built once, for one set of features.
cargo test --locked --release --package jcas-tests --package jcas-train --package jcas-reproduce --package jcas \
    --lib --test golden --test learning --test runs --test reproduction --test training
