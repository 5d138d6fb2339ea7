#!/usr/bin/env bash
# Uses jcas from an empty folder outside the repository.
#
#   use.sh pkg-config PREFIX   an installed library, by pkg-config: shared, then static
#   use.sh cmake PREFIX        an installed library, by find_package
#   use.sh subdirectory        the sources, by add_subdirectory
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
how=$1
prefix=${2:-}
outside=$(mktemp -d)
trap 'rm -rf "$outside"' EXIT
cp "$root"/examples/c/minimal.c "$root"/examples/cpp/fleet.cpp \
    "$root"/tests/package/CMakeLists.txt "$outside"
cd "$outside"

# Compiles an example by the lines in its own head, runs it, and leaves no library path to help.
by_its_own_lines() {
    local lines
    lines=$(sed -nE 's,^[ */]*((libdir=|cc |c\+\+ ).*),\1,p' "$1" | sed 's/ && .*//')
    [[ $lines == *"$1"* ]] || { echo "$1 does not say how it is compiled" >&2; exit 1; }
    eval "$lines"
    env -u LD_LIBRARY_PATH ./a.out >/dev/null
}

case $how in
pkg-config)
    export PKG_CONFIG_PATH=$prefix/lib/pkgconfig
    [[ -n $(find "$prefix" -path '*licenses*' -name LICENSE-MIT) ]]
    if readelf --sections "$prefix/lib/libjcas.so" | grep --quiet '\.debug_info'; then
        echo "the shared library is not stripped" >&2
        exit 1
    fi
    cc minimal.c $(pkg-config --cflags --libs jcas) -o shared
    LD_LIBRARY_PATH=$prefix/lib ./shared
    readelf --dynamic shared | grep --quiet 'libjcas.so.0.1'
    # The compiler prefers a shared library where both are there, so the static one is named.
    cc minimal.c $(pkg-config --cflags jcas) "$prefix/lib/libjcas.a" \
        $(pkg-config --libs-only-l --static jcas | sed 's/-ljcas//') -o static
    ./static
    if readelf --dynamic static | grep --quiet libjcas; then
        echo "the static program wants the shared library" >&2
        exit 1
    fi
    c++ -std=c++17 fleet.cpp $(pkg-config --cflags --libs jcas) -o fleet
    LD_LIBRARY_PATH=$prefix/lib ./fleet
    cp "$root"/examples/c/*.c .
    for example in *.c *.cpp; do by_its_own_lines "$example"; done
    ;;
cmake)
    cmake -B build -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
    cmake --build build >/dev/null
    ctest --test-dir build --output-on-failure
    ;;
subdirectory)
    cmake -B build -DJCAS_SOURCE="$root" -DJCAS_CARGO_PROFILE=release \
        ${CARGO_TARGET_DIR:+"-DJCAS_CARGO_TARGET_DIR=$CARGO_TARGET_DIR"} >/dev/null
    cmake --build build >/dev/null
    ctest --test-dir build --output-on-failure
    ;;
*)
    echo "use.sh pkg-config PREFIX | cmake PREFIX | subdirectory" >&2
    exit 2
    ;;
esac
