#!/bin/sh
# Builds and runs the same host program for OSPRay and for an installed Étendue, and counts what each needs.
#
#   peers/ospray/run.sh PREFIX     PREFIX: where `make install PREFIX=...` put the library
set -eu
prefix=${1:?where is the library installed?}
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PKG_CONFIG_PATH="$prefix/lib/pkgconfig" LD_LIBRARY_PATH="$prefix/lib"

if ! printf '#include <ospray/ospray.h>\n' | cc -fsyntax-only -xc - 2>/dev/null; then
    echo "SKIPPED: no OSPRay (Debian 13: apt-get install libospray-dev)"
    exit 77
fi
# shellcheck disable=SC2046
cc -std=c99 -O2 "$here/host_etendue.c" -o "$work/etendue" $(pkg-config --cflags --libs etendue)
cc -std=c99 -O2 "$here/host_ospray.c" -o "$work/ospray" -lospray
for library in etendue ospray; do
    functions=$(nm -u "$work/$library" | grep -cE ' (etd_|osp)')
    lines=$(grep -cvE '^[[:space:]]*(/\*.*\*/)?[[:space:]]*$' "$here/host_$library.c")
    echo "$library: $functions different functions, $lines lines"
done
for _ in 1 2 3; do
    "$work/etendue"
    "$work/ospray"
done
