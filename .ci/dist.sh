#!/usr/bin/env bash
# What users without Rust install: built by one command, then used where it lands.
set -euo pipefail
shopt -s inherit_errexit

tools=$CARGO_TARGET_DIR/dist-tools
[[ -x $tools/bin/python ]] || python3 -m venv "$tools"
"$tools/bin/pip" install --quiet --disable-pip-version-check -r .ci/dist_requirements.txt
rustup --quiet target add \
    aarch64-unknown-linux-gnu x86_64-pc-windows-gnu wasm32-unknown-unknown
export PATH=$tools/bin:$PATH

dist=$CARGO_TARGET_DIR/dist
rm -rf "$dist"
cargo xtask dist --out "$dist"
(cd "$dist" && sha256sum --check --quiet SHA256SUMS)

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for archive in "$dist"/jcas-*-linux.tar.gz; do tar -xzf "$archive" -C "$work"; done
python3 -m zipfile -e "$dist"/jcas-*-windows.zip "$work"
intel=$(echo "$work"/jcas-*-x86_64-linux)
arm=$(echo "$work"/jcas-*-aarch64-linux)
windows=$(echo "$work"/jcas-*-x86_64-windows)
golden=(tests/golden/*.jsonl)

echo "no path of this machine, and no symbol of a C library that is newer than 2.17"
for file in "$work"/*/bin/* "$work"/*/lib/libjcas.*; do
    for path in "$PWD" "$HOME"; do
        if grep --quiet --text --fixed-strings "$path/" "$file"; then
            echo "$file has the path $path" >&2
            exit 1
        fi
    done
done
for file in "$work"/*-linux/bin/jcas "$work"/*-linux/lib/libjcas.so; do
    newest=$(readelf --dyn-syms --wide "$file" | grep -o 'GLIBC_[0-9.]*' | sort -uV | tail -n 1)
    [[ $(printf '%s\n' "$newest" GLIBC_2.17 | sort -V | tail -n 1) == GLIBC_2.17 ]] || {
        echo "$file needs $newest" >&2
        exit 1
    }
done

# A program replays the traces through the C interface, and the command replays them by itself. Both
# fail at the first value that differs.
replayed() {
    "$@" "${golden[@]}" >"$work/replayed.txt"
    [[ $(grep -c steps "$work/replayed.txt") == "${#golden[@]}" ]] || {
        cat "$work/replayed.txt" >&2
        exit 1
    }
}

echo "Linux, x86-64: C and C++ programs against the archive, and the golden traces"
tests/package/use.sh pkg-config "$intel"
tests/package/use.sh cmake "$intel"
replayed "$intel/bin/jcas" trace verify

echo "Linux, AArch64, under QEMU"
# /lib, too: the C library must be that of the loader, not another one of this machine.
qemu=(qemu-aarch64 -L /usr/aarch64-linux-gnu -E "LD_LIBRARY_PATH=$arm/lib:/lib")
zig() { python3 -m ziglang cc -target aarch64-linux-gnu.2.17 -std=c11 "$@"; }
zig tests/c/replay.c -I "$arm/include" -L "$arm/lib" -ljcas -lm -o "$work/replay"
replayed "${qemu[@]}" "$work/replay"
replayed "${qemu[@]}" "$arm/bin/jcas" trace verify

echo "Windows, x86-64, under Wine: the C example and the golden traces"
export WINEPREFIX=$work/wine WINEDEBUG=-all WINEDLLOVERRIDES=mscoree,mshtml=
wine=/usr/lib/wine/wine64
mingw() { x86_64-w64-mingw32-gcc -std=c11 -I "$windows/include" "$@"; }
cp "$windows"/bin/* "$work"
# For a Wine that has no bcryptprimitives.dll.
mingw -shared tests/dist/process_prng.c -o "$work/bcryptprimitives.dll"
for program in examples/c/minimal.c tests/c/replay.c; do
    mingw "$program" -L "$windows/lib" -ljcas -o "$work/$(basename "$program" .c).exe"
done
"$wine" "$work/minimal.exe"
replayed "$wine" "$work/replay.exe"
replayed "$wine" "$work/jcas.exe" trace verify

echo "the FMU: its description, and the same episode by the libraries of all three platforms"
unit=$work/unit
python3 -m zipfile -e "$dist"/jcas-*.fmu "$unit"
python3 - "$dist"/jcas-*.fmu <<'END'
import sys
from fmpy.validation import validate_fmu
problems = validate_fmu(sys.argv[1])
sys.exit("\n".join(problems) or None)
END
description=$unit/modelDescription.xml
reference() { sed -n "s/.* name=\"$1\" .*valueReference=\"\([0-9]*\)\".*/\1/p" "$description"; }
token=$(sed -n 's/.*instantiationToken="\([^"]*\)".*/\1/p' "$description")
arguments=("$token")
for name in seed policy state_hash confirmed_count; do arguments+=("$(reference "$name")"); done
cc tests/dist/fly_unit.c -ldl -o "$work/fly_intel"
zig tests/dist/fly_unit.c -ldl -o "$work/fly_arm"
mingw tests/dist/fly_unit.c -o "$work/fly.exe"
library=$unit/binaries
flown=$("$work/fly_intel" "$library/x86_64-linux/jcas.so" "${arguments[@]}")
echo "$flown"
[[ $flown == "$("${qemu[@]}" "$work/fly_arm" "$library/aarch64-linux/jcas.so" "${arguments[@]}")" ]]
[[ $flown == "$("$wine" "$work/fly.exe" "$library/x86_64-windows/jcas.dll" "${arguments[@]}" |
    tr -d '\r')" ]]

echo "Node.js: the missions that the command flies, and the playground's kernel"
mkdir -p "$work/node_modules/jcas"
tar -xzf "$dist"/jcas-*.tgz --strip-components 1 -C "$work/node_modules/jcas"
cp tests/dist/fly.mjs "$work"
for policy in teams greedy; do
    "$intel/bin/jcas" simulate --policy "$policy" --seed 7 --episodes 1 --uavs 12 \
        --trace "$work/flown.jsonl" >/dev/null
    hash=$(grep -o '"state_hash":"[^"]*"' "$work/flown.jsonl" | tail -n 1)
    flown=$(node "$work/fly.mjs" "$policy")
    echo "$policy: $flown"
    [[ $hash == "\"state_hash\":\"$flown\"" ]]
done
base64 --wrap 0 "$work/node_modules/jcas/jcas.wasm" |
    grep --quiet --fixed-strings --file=- "$dist"/jcas-*-playground.html

echo "the same bytes from another folder, with other permissions and another building folder"
copy=$work/copy
mkdir "$copy"
git ls-files -z --cached --others --exclude-standard |
    tar -c --null --files-from - | tar -x -C "$copy"
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
(
    export SOURCE_DATE_EPOCH CARGO_TARGET_DIR=$copy/target
    umask 077
    cd "$copy"
    cargo xtask dist --target x86_64-unknown-linux-gnu --out "$copy/dist"
)
for file in "$copy"/dist/*.{gz,whl}; do cmp "$file" "$dist/$(basename "$file")"; done

echo "Python without a compiler, Rust and network: the wheel flies a trained policy"
twine check --strict "$dist"/*.whl "$dist"/jcas-?.?.?.tar.gz
# The source distribution has every crate that Cargo needs.
tar -xzf "$dist"/jcas-?.?.?.tar.gz -C "$work"
cargo metadata --format-version 1 --manifest-path "$work"/jcas-?.?.?/kernel/Cargo.toml >/dev/null
mkdir "$work/bare"
wheel=$(echo "$dist"/jcas-*manylinux2014_x86_64.whl)
export PIP_DISABLE_PIP_VERSION_CHECK=1
pip download --quiet --only-binary :all: --dest "$work/bare" "$wheel[policy]"
cp -r examples/fly_policy.py policies/mission "$work/bare"
cat >"$work/bare/fly.sh" <<'END'
set -euo pipefail
for tool in cc gcc clang cargo rustc; do
    if command -v $tool; then echo "$tool is here" >&2; exit 1; fi
done
python3 -m venv /tmp/venv
/tmp/venv/bin/pip install --quiet --no-index --find-links /given 'jcas[policy]'
/tmp/venv/bin/python /given/fly_policy.py /given/mission --uavs 15 --hotspots 7 --episodes 20
END
.ci/bare_root.sh "$work/bare" bash /given/fly.sh
