#!/usr/bin/env bash
# The release build: the golden traces, which the debug build has passed as well. The command's
# tests follow that a debug build leaves out because they would take too long.
set -euo pipefail

# In one command, so that everything is built once, for one set of features. Of the planner it is
# a hundred thousand flown missions against the expected time of their plan.
cargo test --locked --release --package jcas-tests --package jcas-cli --package jcas-plan \
    --test golden --test cards --test shipped --test exact --test memory --test refused \
    --test rounds
