#!/bin/sh
# Installs into a prefix and into a stage, and uses both as other programs would: with pkg-config, with CMake, shared and
# static. What is compiled is the program of README.md and the excerpts of docs/c-api.md. Then uninstalls, and looks for
# what was left behind.
#
#   scripts/check_install.sh [HOSTS]      HOSTS: a script that is given the prefix while it is there
set -eu
cd "$(dirname "$0")/.."

die() { printf '%s\n' "$*" >&2; exit 1; }

CC=${CC:-cc}
built=${CARGO_TARGET_DIR:-target}/${ETENDUE_PROFILE:-release}
work=$PWD/target/check-install
rm -rf "$work"
mkdir -p "$work"
prefix=$work/prefix
stage=$work/stage
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
minor=${version%.*}
case $version in 0.*) abi=$minor ;; *) abi=${version%%.*} ;; esac

into_prefix() { make --no-print-directory "$1" PREFIX="$prefix" LIBDIR= DESTDIR=; }
# Another depth of folders than the prefix has, where CMake looks nevertheless.
deep=/opt/etendue/lib/$("$CC" -print-multiarch)
into_stage() { make --no-print-directory "$1" PREFIX=/opt/etendue LIBDIR="$deep" DESTDIR="$stage"; }

into_prefix install
lib=$prefix/lib/libetendue.so.$version

echo "what the libraries show"
names() { nm --defined-only "$@" | awk 'NF == 3 && $2 != "A" { print $3 }' | sort; }
declared=$(grep -o '\betd_[a-z0-9_]*(' include/etendue.h | tr -d '(' | sort -u)
[ "$(names -D "$lib")" = "$declared" ] || die "$lib does not export just what include/etendue.h declares"
[ "$(names -g "$prefix/lib/libetendue.a")" = "$declared" ] || die "libetendue.a shows something else than the interface"
readelf -d "$lib" | grep -q "SONAME.*\[libetendue.so.$abi\]" || die "$lib has another SONAME than libetendue.so.$abi"
[ "$("$prefix/bin/etendue" --version)" = "etendue $version" ] || die "bin/etendue is of another version"

echo "a second install builds nothing"
stat -c %y "$built/libetendue.so" "$built/examples/etendue" "$lib" >"$work/before" 2>/dev/null || true
touch "$prefix/share/etendue/not-ours"
into_prefix install >/dev/null
stat -c %y "$built/libetendue.so" "$built/examples/etendue" >"$work/after" 2>/dev/null || true
head -n 2 "$work/before" | cmp - "$work/after" || die "the second install built anew"

echo "the README's program, shared and static"
# The first block of a language in a document; in the second form every block, each in a function of its own.
first() { awk -v fence="\`\`\`$2" '$0 == fence && !n { on = 1; next } /^```/ { if (on) n = 1; on = 0 } on' "$1"; }
first README.md c >"$work/first.c"
[ -s "$work/first.c" ] || die "README.md has no C program"
flags="-Wall -Wextra -Werror -std=c99 -pedantic"
pc() { PKG_CONFIG_PATH=$prefix/lib/pkgconfig pkg-config "$@"; }
[ "$(pc --modversion etendue)" = "$version" ] || die "etendue.pc is of another version"
# shellcheck disable=SC2046,SC2086
"$CC" $flags "$work/first.c" $(pc --cflags --libs etendue) -o "$work/shared"
# shellcheck disable=SC2046,SC2086
"$CC" $flags "$work/first.c" $(pc --cflags --libs etendue-static) -o "$work/static"
readelf -d "$work/static" | grep -q 'libetendue' && die "the static program needs the shared library"
for kind in shared static; do
    LD_LIBRARY_PATH=$prefix/lib "$work/$kind"
    mv cornell.png "$work/$kind.png"
done
cmp "$work/shared.png" "$work/static.png"

echo "two Rust libraries in one program"
cat >"$work/other.rs" <<'END'
#[unsafe(no_mangle)]
pub extern "C" fn other(number: i32) -> i32 {
    std::panic::catch_unwind(|| if number > 3 { std::panic::resume_unwind(Box::new(())) } else { number }).unwrap_or(-1)
}
END
rustc --edition 2024 --crate-type staticlib "$work/other.rs" -o "$work/libother.a"
cat >"$work/two.c" <<'END'
#include <etendue.h>
int other(int number);
int main(void) { return !(other(2) == 2 && other(9) == -1 && etd_device_new(NULL, NULL) == ETD_INVALID_ARGUMENT); }
END
# shellcheck disable=SC2046
"$CC" "$work/two.c" "$work/libother.a" $(pc --cflags --libs etendue-static) -o "$work/two"
"$work/two"

echo "CMake, from the prefix and from the stage"
into_stage install
mkdir -p "$work/project"
cp "$work/first.c" "$work/project/first.c"
first README.md cpp >"$work/project/first.cpp"
cat >"$work/project/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.13)
project(first C CXX)
find_package(etendue ${WANTED} CONFIG REQUIRED)
add_executable(shared first.c)
target_link_libraries(shared PRIVATE etendue::etendue)
add_executable(static first.c)
target_link_libraries(static PRIVATE etendue::etendue_static)
add_executable(layer first.cpp)
target_compile_features(layer PRIVATE cxx_std_17)
target_link_libraries(layer PRIVATE etendue::etendue)
END
configure() { cmake -S "$work/project" -B "$work/$1" -DCMAKE_PREFIX_PATH="$2" -DWANTED="$3" >"$work/$1.log" 2>&1; }
for place in "$prefix" "$stage/opt/etendue"; do
    rm -rf "$work/build"
    if ! configure build "$place" "$minor" || ! cmake --build "$work/build" >>"$work/build.log" 2>&1; then
        cat "$work/build.log" >&2
        exit 1
    fi
    for program in "$work"/build/shared "$work"/build/static "$work"/build/layer; do
        (cd "$work" && ln -sfn ../../scenes scenes && "$program" && cmp cornell.png shared.png && rm cornell.png)
    done
done
for wrong in 0.0 99; do
    configure "wrong-$wrong" "$prefix" "$wrong" && die "find_package(etendue $wrong) took $version"
done

echo "a stage knows nothing of its place"
if grep -rlI "$stage" "$stage"; then die "these files name the stage"; fi
grep -qx "libdir=$deep" "$stage$deep/pkgconfig/etendue.pc" || die "etendue.pc of the stage"

echo "the excerpts of docs/c-api.md"
scripts/check_excerpts.sh "$(pc --variable=includedir etendue)" "$work"

if [ $# -gt 0 ] && [ -x "$1" ]; then
    echo "hosts"
    REQUIRE_ALL=1 "$1" "$prefix"
fi

echo "uninstall leaves what is not ours, and nothing else"
into_prefix uninstall
[ "$(cd "$prefix" && find . -type f -o -type l)" = ./share/etendue/not-ours ] || die "files were left in $prefix, or lost"
rm -r "$prefix"
into_prefix install >/dev/null 2>&1
touch "$prefix/share/not-ours"
into_prefix install >/dev/null 2>&1
rm "$prefix/share/not-ours"
into_prefix uninstall
into_stage uninstall
for place in "$prefix" "$stage"; do
    left=$(find "$place" -mindepth 1 2>/dev/null | head -n 5)
    [ -z "$left" ] || die "left behind: $left"
done
rm -rf "$work"
