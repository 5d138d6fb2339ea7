#!/usr/bin/env bash
# Runs a command in a root that has Python and the system's libraries, but no compiler, no Rust and
# no network. The folder is /given there.
#
#   bare_root.sh FOLDER COMMAND...
set -euo pipefail

if [[ ${1:-} != --inside ]]; then
    exec unshare --mount --net "$0" --inside "$@"
fi
folder=$2
shift 2

root=/mnt # The mount is seen in this namespace only.
mount -t tmpfs none "$root"
share() {
    mkdir -p "$root$2"
    mount --rbind "$1" "$root$2"
}
share /usr/lib /usr/lib
ln -s usr/lib "$root/lib"
if [[ -d /usr/lib64 ]]; then share /usr/lib64 /usr/lib64 && ln -s usr/lib64 "$root/lib64"; fi
share /dev /dev
share "$folder" /given
mkdir -p "$root/tmp" "$root/usr/bin"
ln -s usr/bin "$root/bin"
cp /bin/bash /usr/bin/env "$root/usr/bin/"
prefix=$(python3 -c 'import sys; print(sys.base_prefix)')
if [[ $prefix == /usr ]]; then
    cp /usr/bin/python3 "$root/usr/bin/"
else
    # An interpreter outside the system's folders has its libraries with it.
    share "$prefix" "$prefix"
fi
path=$prefix/bin:/usr/bin
exec env -i PATH="$path" HOME=/tmp "$(command -v chroot)" "$root" "$@"
