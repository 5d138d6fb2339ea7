#!/usr/bin/env bash
# The kernel, linked into a program with nothing beneath it: no libc, no std, no allocator.
set -euo pipefail

# Static and without start files or default libraries, so that a symbol the kernel needs from
# outside is a link error.
cargo rustc --locked --quiet --release --manifest-path tests/no_std/Cargo.toml \
    --bin jcas-no-std -- \
    -C relocation-model=static -C link-args='-nostdlib -static -no-pie'
program=$CARGO_TARGET_DIR/release/jcas-no-std

# Every symbol of the program belongs to the kernel, to core, or to the program itself.
symbols=$(nm --demangle "$program")
unwanted=' U |\bstd::|\balloc::|__rust_|__rdl_|malloc|free$|printf|__libc|pthread'
foreign=$(grep -iE "$unwanted" <<<"$symbols" || true)
if [[ -n $foreign ]]; then
    printf 'symbols of libc, std or an allocator:\n%s\n' "$foreign" >&2
    exit 1
fi
if ! grep -q 'jcas_no_std' <<<"$symbols"; then
    echo "nm shows no symbol of the program's own" >&2
    exit 1
fi

# It flies, and computes what an ordinary program computes.
bare=$("$program")
hosted=$(cargo run --locked --quiet --release --manifest-path tests/no_std/Cargo.toml \
    --example hosted)
echo "bare machine $bare, hosted $hosted, $(wc -l <<<"$symbols") symbols, none foreign"
[[ $bare == "$hosted" ]]
