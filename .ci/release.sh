#!/usr/bin/env bash
# The release build: the golden traces, which the debug build has passed as well, and training, which a
# debug build would take too long for.
set -euo pipefail

cargo test --locked --release --package jcas-tests --test golden
cargo test --locked --release --package jcas-train --package jcas-reproduce
cargo test --locked --release --package jcas --test training
