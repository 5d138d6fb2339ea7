#!/usr/bin/env bash
# Formatting, clippy and rustdoc, over everything, with warnings as errors.
set -euo pipefail

cargo fmt --all --check
for crate in cortex_m no_std portable; do
    cargo fmt --check --manifest-path tests/$crate/Cargo.toml
done
cargo clippy --locked --quiet --workspace --all-targets -- -D warnings
RUSTDOCFLAGS="-D warnings" cargo doc --locked --quiet --workspace --no-deps

# Runs a search, and succeeds if it finds nothing.
nothing() {
    local status=0
    "$@" || status=$?
    ((status == 1))
}

# Lines that are too long, apart from tables and addresses, which cannot be broken.
by_hand=(':(exclude,attr:linguist-generated)' ':(exclude,attr:linguist-vendored)')
LC_ALL=C.UTF-8 nothing git grep --line-number -I --perl-regexp \
    '^(?!\s*\|)(?!.*://).{101,}$' -- .ci '*.rs' '*.md' '*.py' '*.c' '*.cc' '*.cpp' '*.h' '*.hpp' \
    '*.js' '*.mjs' '*.toml' '*.yml' '*.cmake' "${by_hand[@]}"

# Marks of a merge that was not settled.
nothing git grep --line-number -I --extended-regexp '^(<<<<<<<|>>>>>>>) '

# Subjects of commits: `area: imperative change`, at most 72 columns.
nothing grep --perl-regexp --invert-match '^(?!.{73})[a-z0-9][a-z0-9_./, -]*: [a-z].*[^.]$' \
    <(git log --no-merges --max-count 100 --format=%s)

typos=$CARGO_TARGET_DIR/typos-1.52.0
[[ -x $typos/bin/typos ]] || {
    python3 -m venv "$typos"
    "$typos/bin/pip" install --quiet --disable-pip-version-check "typos==${typos##*-}"
}
"$typos/bin/typos" --format brief

# Sentences of comments and documents, and files that nothing names.
cargo run --locked --quiet --package xtask -- tidy
