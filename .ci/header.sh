#!/usr/bin/env bash
# The C header is what the sources give, and each public header compiles alone in every language it
# promises, under both compilers, without a warning.
set -euo pipefail

cargo run --locked --quiet --package jcas-ffi --example generate_header -- --check

readonly WARNINGS="-Wall -Wextra -Wpedantic -Werror -fsyntax-only"
for standard in c99 c11 c17; do
    for compiler in gcc clang; do
        $compiler -x c -std=$standard $WARNINGS include/jcas.h
        echo "jcas.h as $standard under $compiler"
    done
done
for compiler in g++ clang++; do
    $compiler -x c++ -std=c++17 $WARNINGS include/jcas.h
    echo "jcas.h as c++17 under $compiler"
done

# Nothing that a C author would stumble over, and no name outside the library's own space.
exported=$(nm --dynamic --defined-only "$CARGO_TARGET_DIR/debug/libjcas.so" | awk '$2 == "T" { print $3 }')
foreign=$(grep -v '^jcas_' <<<"$exported" || true)
[[ -z $foreign ]] || { printf 'exported symbols without jcas_:\n%s\n' "$foreign" >&2; exit 1; }
echo "$(wc -l <<<"$exported") symbols, all jcas_"
