#!/usr/bin/env bash
# The documentation site: built and opened in headless Chromium. The cookbook's recipes are run as
# they stand.
set -euo pipefail

root=$PWD
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The site's own environment: MkDocs and what it needs.
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check -r site/requirements.txt
"$work/venv/bin/python" site/build.py --out "$work/site"
node tests/browser/site.mjs "$work/site"

# Writes the fenced blocks of a language in the cookbook to the standard output.
blocks() { sed -n "/^\`\`\`$1\$/,/^\`\`\`\$/p" "$root/docs/cookbook.md" | sed '/^```/d'; }

cargo build --locked --quiet --release --package jcas-cli
export PATH=$CARGO_TARGET_DIR/release:$PATH
mkdir "$work/recipes"
cd "$work/recipes"
blocks toml >scenario.toml
blocks csv >radar.csv
blocks console | sed 's/^\$ //' >commands.sh
bash -euo pipefail commands.sh >commands.txt
test -s flight.html && test -s radar.svg && test -s plan.svg && test -s pilots/replay.html
tail -n 1 commands.txt

# The environment of the section `python`, or a new one with the package.
python=${JCAS_VENV:-$CARGO_TARGET_DIR/venv}/bin/python
if [[ ! -x $python ]]; then
    python=$work/venv/bin/python
    "$python" -m pip install --quiet --disable-pip-version-check "$root/python"
fi
blocks python >recipes.py
"$python" recipes.py
