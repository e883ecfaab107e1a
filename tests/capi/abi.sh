#!/bin/sh
# The binary interface against tests/capi/abi.txt: layout of structures, values, prototypes, exported symbols.
#
# Usage: abi.sh HEADER LIBRARY          compares
#        abi.sh HEADER LIBRARY --write  writes abi.txt anew: think of the version of the interface first
# CC is the compiler.
set -eu
export LC_ALL=C
here=$(cd "$(dirname "$0")" && pwd)
header=$1
library=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The header without comments, preprocessor lines and line breaks inside declarations.
tr '\n' '\001' <"$header" | sed 's|/\*[^*]*\*\+\([^/*][^*]*\*\+\)*/||g' | tr '\001' '\n' >"$work/bare"

# Every structure, value, macro and function of the header is in layout.c or misuse.c.
missing=0
need() {
    if ! grep -qw -- "$2" "$here/$1"; then
        echo "abi.sh: $2 is in the header and not in $1" >&2
        missing=1
    fi
}
for name in $(grep -o 'ETD_[A-Z0-9_]*' "$work/bare" | sort -u); do
    need layout.c "$name"
done
for name in $(sed -n 's/^typedef struct \(etd_[a-z_]*\) {.*/\1/p; s/^enum \(etd_[a-z_]*\)$/\1/p' "$work/bare"); do
    need layout.c "$name"
done
nm -D --defined-only "$library" | awk '$2 ~ /[A-Z]/ {print $3}' | grep -v '^_' | sort >"$work/symbols"
for name in $(cat "$work/symbols"); do
    need misuse.c "\"$name\""
done
if grep -v '^etd_' "$work/symbols"; then
    echo "abi.sh: the library exports the names above, which are not etd_" >&2
    missing=1
fi
sed -n 's/.*[ *]\(etd_[a-z_]*\)(.*/\1/p' "$work/bare" | sort -u >"$work/declared"
if ! diff "$work/declared" "$work/symbols" >&2; then
    echo "abi.sh: what is declared (<) is not what is exported (>)" >&2
    missing=1
fi

${CC:-cc} -std=c99 -Wall -Wextra -Wpedantic -Werror -I"$(dirname "$header")" "$here/layout.c" -o "$work/layout"
{
    "$work/layout"
    echo prototypes
    grep -v '^ *#' "$work/bare" | tr '\n' ' ' | tr ';' '\n' | sed 's/  */ /g; s/^ //; s/^extern "C" { //; s/( /(/g' |
        grep '^\(const \)\{0,1\}\(etd_status\|void\|char\|uint32_t\) .*(\|^typedef .*(\*' | sed 's/^/  /'
    echo symbols
    sed 's/^/  /' "$work/symbols"
} >"$work/abi.txt"
if [ "${3:-}" = --write ]; then
    cp "$work/abi.txt" "$here/abi.txt"
elif ! diff -u "$here/abi.txt" "$work/abi.txt" >&2; then
    echo "abi.sh: the binary interface has changed; if it should, run $0 $1 $2 --write" >&2
    missing=1
fi
exit $missing
