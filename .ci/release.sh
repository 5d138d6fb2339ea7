#!/usr/bin/env bash
# The release build: the golden traces, which the debug build has passed as well, and training, which a
# debug build would take too long for.
set -euo pipefail

cargo test --locked --release --package jcas-tests --test golden
# In one command, so that the tensor library is built once, for one set of features.
cargo test --locked --release --package jcas-train --package jcas-reproduce --package jcas \
    --lib --test learning --test runs --test reproduction --test training
