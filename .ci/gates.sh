#!/usr/bin/env bash
# What must hold before a release: all packages have accepted licences and sources, and the registry
# would take them.
set -euo pipefail
shopt -s inherit_errexit

readonly DENY=0.19.0
tools=${XDG_CACHE_HOME:-$HOME/.cache}/jcas/cargo-deny-$DENY
if [[ ! -x $tools/bin/cargo-deny ]]; then
    echo "building cargo-deny $DENY into $tools"
    CARGO_PROFILE_DEV_DEBUG=0 CARGO_TARGET_DIR=$CARGO_TARGET_DIR/cargo-deny \
        cargo install --quiet --locked --debug --root "$tools" cargo-deny@$DENY
fi
"$tools/bin/cargo-deny" --locked check --hide-inclusion-graph bans licenses sources

# In the order of their dependencies. Only the kernel's packages are also built from their archives,
# since those of the others take minutes.
echo "cargo publish --dry-run"
cargo publish --dry-run --allow-dirty --locked --quiet --workspace --no-verify
cargo publish --dry-run --allow-dirty --locked --quiet --package jcas-core --package jcas-policy \
    --package jcas-simd --package jcas-trace
