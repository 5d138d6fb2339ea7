#!/usr/bin/env bash
# The programs of the documents, copied out as they stand into an empty folder, compiled and run.
#
#   snippets.sh PREFIX    where the library is installed
#
# Every fenced block of C and C++ is a whole program. Of Rust the first block of docs/rust.md is.
set -euo pipefail

prefix=$1
root=$PWD
outside=$(mktemp -d)
trap 'rm -rf "$outside"' EXIT

# Writes the fenced blocks of a language in a document to <name>-<number>.<language>.
snippets() {
    local language=$1 document=$2
    local name=$outside/$(basename "$document" .md)
    awk -v fence="\`\`\`$language" -v name="$name" -v suffix="$language" '
        $0 == fence { inside = 1; file = name "-" ++count "." suffix; printf "" >file; next }
        /^```/ { inside = 0 }
        inside { print >file }' "$document"
}
for document in README.md docs/*.md; do
    for language in c cpp rust; do snippets $language "$document"; done
done

cd "$outside"
export PKG_CONFIG_PATH=$prefix/lib/pkgconfig
flags="$(pkg-config --cflags --libs jcas) -Wl,-rpath,$prefix/lib"
programs=0
for program in *.c *.cpp; do
    [[ -e $program ]] || continue
    case $program in
    *.c) cc -Wall -Wextra -Werror "$program" $flags -o program ;;
    *.cpp) c++ -std=c++17 -Wall -Wextra -Werror "$program" $flags -o program ;;
    esac
    printf '%s: %s\n' "$program" "$(./program | tail -n 1)"
    programs=$((programs + 1))
done
# A document that loses its fences must not pass.
((programs >= 8)) || { echo "only $programs programs found" >&2; exit 1; }

cargo init --quiet --vcs none --name snippet rust
cp rust-1.rust rust/src/main.rs
cd rust
cargo add --quiet --path "$root/core" --features alloc jcas-core
cargo run --quiet
