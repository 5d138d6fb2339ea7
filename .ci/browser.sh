#!/usr/bin/env bash
# A replay page, played by keys in headless Chromium and compared with its trace.
set -euo pipefail

out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
for trace in tests/golden/*.jsonl; do
    page=$out/$(basename "$trace" .jsonl).html
    cargo run --locked --quiet --release --package jcas -- replay "$trace" -o "$page"
    node tests/browser/replay.mjs "$trace" "$page"
done
