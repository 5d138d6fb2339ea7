#!/usr/bin/env bash
# The release build: the golden traces, which the debug build has passed as well. The command's
# tests follow that a debug build leaves out because they would take too long.
set -euo pipefail

# In one command, so that everything is built once, for one set of features.
cargo test --locked --release --package jcas-tests --package jcas-cli \
    --test golden --test cards --test shipped

# A hundred thousand flown missions against the expected time of their plan.
cargo test --locked --release --package jcas-plan
