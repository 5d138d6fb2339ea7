#!/usr/bin/env bash
# What users without Rust install: built by one command, then used where it lands.
set -euo pipefail
shopt -s inherit_errexit

tools=$CARGO_TARGET_DIR/dist-tools
[[ -x $tools/bin/python ]] || python3 -m venv "$tools"
"$tools/bin/pip" install --quiet --disable-pip-version-check -r .ci/dist_requirements.txt
export PATH=$tools/bin:$PATH

dist=$CARGO_TARGET_DIR/dist
cargo xtask dist --target x86_64-unknown-linux-gnu --out "$dist"
(cd "$dist" && sha256sum --check --quiet SHA256SUMS)

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for archive in "$dist"/jcas-*-linux.tar.gz; do tar -xzf "$archive" -C "$work"; done

echo "no path of this machine, and no symbol of a C library that is newer than 2.17"
for file in "$work"/*-linux/bin/jcas "$work"/*-linux/lib/libjcas.{so,a}; do
    for path in "$PWD" "$HOME"; do
        if grep --quiet --text --fixed-strings "$path/" "$file"; then
            echo "$file has the path $path" >&2
            exit 1
        fi
    done
done
for file in "$work"/*-linux/bin/jcas "$work"/*-linux/lib/libjcas.so; do
    newest=$(objdump -T "$file" | grep -o 'GLIBC_[0-9.]*' | sort -uV | tail -n 1)
    [[ $(printf '%s\n' "$newest" GLIBC_2.17 | sort -V | tail -n 1) == GLIBC_2.17 ]] || {
        echo "$file needs $newest" >&2
        exit 1
    }
done

echo "Linux, x86-64: C and C++ programs against the archive, and the golden traces"
here=$(echo "$work"/jcas-*-x86_64-linux)
tests/package/use.sh pkg-config "$here"
tests/package/use.sh cmake "$here"
"$here/bin/jcas" trace verify tests/golden/*.jsonl | tail -n 1
