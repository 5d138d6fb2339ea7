#!/usr/bin/env bash
# The tests that compile C and C++, with each compiler. The first section, which any machine passes,
# takes the first C compiler that it finds and may find none for C++.
set -euo pipefail

# Of the whole workspace, as there, so that nothing is built again.
JCAS_COMPILERS=all cargo test --locked --workspace \
    --test abi --test abi_policy --test abi_traces --test header
