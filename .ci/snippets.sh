#!/usr/bin/env bash
# The README's C, C++ and Rust snippets, copied out as they stand into an empty folder.
#
#   snippets.sh PREFIX    where the library is installed
set -euo pipefail

prefix=$1
root=$PWD
outside=$(mktemp -d)
trap 'rm -rf "$outside"' EXIT

# The first fenced block of a language.
snippet() {
    awk -v fence="\`\`\`$1" '$0 == fence { inside = 1; next } /^```/ { if (inside) exit } inside' README.md
}
mkdir -p "$outside/src"
snippet c >"$outside/snippet.c"
snippet cpp >"$outside/snippet.cpp"
snippet rust >"$outside/src/main.rs"

cd "$outside"
export PKG_CONFIG_PATH=$prefix/lib/pkgconfig
flags="$(pkg-config --cflags --libs jcas) -Wl,-rpath,$prefix/lib"
cc snippet.c $flags -o c
./c | tail -n 1
c++ -std=c++17 snippet.cpp $flags -o cpp
./cpp

cargo init --quiet --vcs none --name snippet
cargo add --quiet --path "$root/core" --features alloc jcas-core
cargo run --quiet
