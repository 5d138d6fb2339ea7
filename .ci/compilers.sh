#!/usr/bin/env bash
# The tests that compile C and C++, by the compilers that the section `test` does not take.
set -euo pipefail

# Of the whole workspace, as there, so that nothing is built again.
JCAS_COMPILERS="clang g++ clang++" cargo test --locked --workspace \
    --test abi --test abi_plans --test abi_policy --test abi_traces --test header
