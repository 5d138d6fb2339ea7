#!/usr/bin/env bash
# What must hold before a release. The interfaces of C and Rust are unchanged, all packages have
# accepted licences and sources, and the registry would take them.
#
#   gates.sh           checks
#   gates.sh --bless   writes the baselines of the interface and of the public items anew
set -euo pipefail
shopt -s inherit_errexit

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# A variable of each function's type: its debug information has the whole interface, as C sees it.
{
    echo '#include <jcas_dl.h>'
    sed -nE 's/^typedef .*[ *](jcas_[a-z0-9_]+)_fn\(.*/\1_fn *address_of_\1;/p' include/jcas_dl.h
} >"$work/interface.c"
cc -g -shared -fPIC -ffile-prefix-map="$work"=. -I include "$work/interface.c" \
    -o "$work/interface.so"
api() { cargo run --locked --quiet --manifest-path tests/api/Cargo.toml -- "$@"; }
if [[ ${1:-} == --bless ]]; then
    api --bless
    abidw --no-corpus-path --no-comp-dir-path --no-show-locs --type-id-style hash \
        --out-file tests/dist/jcas.abi "$work/interface.so"
    exit
fi
echo "abidiff: functions may be added; all else needs \`.ci/gates.sh --bless\` and a new version"
abidiff --no-added-syms tests/dist/jcas.abi "$work/interface.so"

echo "the public items of the Rust libraries, and their lists in tests/api/lists"
api

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
