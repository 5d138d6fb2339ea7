#!/usr/bin/env bash
# The tests of the interface under AddressSanitizer and UndefinedBehaviorSanitizer, under
# ThreadSanitizer, and under valgrind. The sanitizers watch the Rust code and its std as well. Both
# are built instrumented, from the source that Debian packages, which cargo calls an unstable
# feature.
set -euo pipefail
shopt -s inherit_errexit

out=$CARGO_TARGET_DIR/sanitizers
mkdir -p "$out"
readonly HOST=x86_64-unknown-linux-gnu
readonly FLAGS="-std=c11 -O1 -g -fno-omit-frame-pointer -Iinclude"
readonly SYSTEM="-lpthread -ldl -lm"

# The library, instrumented by one sanitizer.
instrumented() {
    local sanitizer=$1
    RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1 RUSTFLAGS="-Zsanitizer=$sanitizer" \
        CARGO_TARGET_DIR=$out/$sanitizer cargo rustc --locked --quiet --profile dev \
        -Zbuild-std=std --target $HOST --package jcas-ffi --lib --crate-type staticlib
    echo "$out/$sanitizer/$HOST/debug/libjcas.a"
}

echo "AddressSanitizer and UndefinedBehaviorSanitizer"
library=$(instrumented address)
check="clang $FLAGS -fsanitize=address,undefined -fno-sanitize-recover=all"
$check tests/c/abuse*.c "$library" $SYSTEM -o "$out/abuse"
$check tests/c/replay.c "$library" $SYSTEM -o "$out/replay"
$check tests/c/policies.c "$library" $SYSTEM -o "$out/policies"
$check tests/c/traces.c "$library" $SYSTEM -o "$out/traces"
$check tests/c/plans.c "$library" $SYSTEM -o "$out/plans"
"$out/abuse"
"$out/replay" tests/golden/*.jsonl
"$out/policies" policies/mission/policy.safetensors >"$out/policies.txt"
"$out/traces" "$out" tests/golden/*.jsonl
"$out/plans" >"$out/plans.txt"

echo "ThreadSanitizer"
library=$(instrumented thread)
# Clang's runtime is older than the compiler's code; the Rust toolchain brings one that fits.
runtime=$(rustc --print sysroot)/lib/rustlib/$HOST/lib/librustc-stable_rt.tsan.a
clang $FLAGS -fsanitize=thread -c tests/c/threads.c -o "$out/threads.o"
clang "$out/threads.o" "$library" -Wl,--whole-archive "$runtime" -Wl,--no-whole-archive \
    -rdynamic $SYSTEM -lrt -lresolv -o "$out/threads"
TSAN_OPTIONS=halt_on_error=1 "$out/threads"

echo "valgrind"
cargo build --locked --quiet --release --package jcas-ffi
gcc $FLAGS tests/c/abuse*.c "$CARGO_TARGET_DIR/release/libjcas.a" $SYSTEM -o "$out/abuse"
valgrind --quiet --error-exitcode=1 --leak-check=full "$out/abuse"
