#!/usr/bin/env bash
# The Python package, installed from the clone into an environment of its own: style, types, every test,
# with RLlib on two Ray nodes among them.
set -euo pipefail

venv=$CARGO_TARGET_DIR/python
[[ -x $venv/bin/python ]] || python3 -m venv "$venv"
"$venv/bin/pip" install --quiet --disable-pip-version-check "./python[test,rllib]"

cd python
"$venv/bin/ruff" check .
"$venv/bin/mypy"
"$venv/bin/pytest" --run-heavy
