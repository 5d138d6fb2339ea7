#!/usr/bin/env bash
# The laboratory. First the paper's study in Python: lint, its lists, its test, and the page beside
# its tables. Then training, a workspace of its own, in a release build.
set -euo pipefail

venv=$(realpath -m "${CARGO_TARGET_DIR:-target}/venv-lab")
[[ -x $venv/bin/python ]] || python3 -m venv "$venv"
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check \
    -r lab/paper/requirements.txt 'pytest>=8' 'ruff>=0.6'
"$venv/bin/ruff" check lab/paper
"$venv/bin/ruff" format --check lab/paper
(cd lab && "$venv/bin/python" -m pytest -q -p no:cacheprovider paper)

cd lab
cargo fmt --all --check
cargo clippy --locked --quiet --release --workspace --all-targets -- -D warnings
RUSTDOCFLAGS="-D warnings" cargo doc --locked --quiet --release --workspace --no-deps
cargo test --locked --release --workspace
