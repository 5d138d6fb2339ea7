#!/usr/bin/env bash
# Installs the Debian packages that the other sections need and that are missing.
set -euo pipefail

PACKAGES=(
    # C and C++ consumers, sanitizers
    g++ clang libclang-rt-14-dev cmake make pkg-config valgrind
    # ns-3, and two libraries that its pkg-config files name without depending on them
    libns3-dev libgsl-dev libsqlite3-dev
    # AArch64 and wasm32: a Rust compiler with a second target's std and with the source of std
    rustc-web libstd-rust-web-dev:arm64 rust-web-src
    gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user
    # s390x and ARMv7
    gcc-s390x-linux-gnu libc6-dev-s390x-cross gcc-arm-linux-gnueabihf libc6-dev-armhf-cross
    # a microcontroller
    qemu-system-arm
    # programs for Windows, and the comparison of binary interfaces
    gcc-mingw-w64-x86-64 wine64
    # figures and the replay page
    libfontconfig-dev fonts-dejavu-core chromium
    # the C reference of the documentation site
    doxygen
)
# Not where the machine has them from elsewhere.
command -v node >/dev/null || PACKAGES+=(nodejs)
python3 -c 'import ensurepip' 2>/dev/null || PACKAGES+=(python3-venv)

sudo=
((EUID == 0)) || sudo=sudo

missing=()
for package in "${PACKAGES[@]}"; do
    status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
    [[ $status == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
    echo "all ${#PACKAGES[@]} packages are there"
    exit
fi

echo "installing: ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
dpkg --print-foreign-architectures | grep -qx arm64 || $sudo dpkg --add-architecture arm64
$sudo apt-get update -qq
$sudo apt-get install -y -qq --no-install-recommends -o DPkg::Lock::Timeout=300 \
    -o Acquire::Retries=3 "${missing[@]}" >/dev/null
