#!/usr/bin/env bash
# The ns-3 example: ns-3 moves the UAVs and decides which of them hear each other. A baseline and
# the shipped policy fly, and their missions are complete.
set -euo pipefail
shopt -s inherit_errexit

prefix=$(.ci/cmake_install.sh)
build=$CARGO_TARGET_DIR/ns3
cmake -S examples/ns3 -B "$build" -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$build" >/dev/null
flown=$("$build/fleet" && "$build/fleet" --policy=policies/mission/policy.safetensors)
echo "$flown"
[[ $(grep -c ' complete ' <<<"$flown") == 4 ]]
