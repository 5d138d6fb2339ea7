#!/usr/bin/env bash
# The tour: the report and what it shows are there.
set -euo pipefail

out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
cargo run --locked --quiet --release --package jcas-cli -- tour --episodes 20 --out "$out"
for file in report.html paper.csv search.csv paper.html search.html \
    paper/success_over_uav_count.svg; do
    test -s "$out/$file"
done
