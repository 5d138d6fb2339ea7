#!/usr/bin/env bash
# Replay pages and the playground in headless Chromium: what they show is what the kernel computes.
set -euo pipefail

out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
for trace in tests/golden/*.jsonl; do
    page=$out/$(basename "$trace" .jsonl).html
    cargo run --locked --quiet --release --package jcas-cli -- replay "$trace" -o "$page"
    node tests/browser/replay.mjs "$trace" "$page"
done

kernel=$CARGO_TARGET_DIR/wasm32-unknown-unknown/release/jcas_web.wasm
[[ -f $kernel ]] || .ci/wasm.sh
cargo xtask web --wasm "$kernel" --out "$out/index.html"
node tests/browser/playground.mjs "$out/index.html" "$CARGO_TARGET_DIR/release/jcas"
