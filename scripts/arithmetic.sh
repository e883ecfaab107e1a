#!/bin/sh
# The same image from every build: without optimisation, as in development, as released, with fused multiply-add, and with Embree
# held to older instruction sets. One line for each comparison; fails if one is off by more than its tolerance.
#
# Usage: scripts/arithmetic.sh
#   It takes minutes, most of them for builds, which are kept in target/ and target/arithmetic/.
#
# Étendue's own arithmetic has one result: no build may change a bit of it. Embree's kernels of different instruction sets
# round differently, so there a path may now and then take another turn: what is owed is the same mean.
set -eu
cd "$(dirname "$0")/.."
scenes="room cornell"
work=target/arithmetic
mkdir -p "$work"
failed=0
skipped=0

say() {
    printf '== %s\n' "$*"
}

skip() {
    echo "!! SKIPPED: $*" >&2
    skipped=$((skipped + 1))
}

# row WHAT GOT TOLERANCE VERDICT: one comparison.
row() {
    printf '| %-48s | %-20s | %-12s | %s |\n' "$1" "$2" "$3" "$4"
    [ "$4" = pass ] || failed=$((failed + 1))
}

# build NAME FOLDER [CARGO OPTION...]: the command line, in a target folder of its own; then images of all scenes by it.
build() {
    name=$1
    folder=$2
    shift 2
    say "building: $name"
    cargo build --quiet --locked --example etendue --target-dir "$folder" "$@"
    profile=debug
    [ "${1:-}" != --release ] || profile=release
    render "$name" "$folder/$profile/examples/etendue"
}

# render NAME PROGRAM: images of all scenes.
render() {
    for scene in $scenes; do
        "$2" render "scenes/$scene.json" --output "$work/$1-$scene.exr" --resolution 100x75 --spp 16 --threads 2 --quiet
    done
}

# same NAME TITLE: every byte as released.
same() {
    for scene in $scenes; do
        if cmp -s "$work/release-$scene.exr" "$work/$1-$scene.exr"; then
            row "$2: $scene" "the same bytes" "none" pass
        else
            row "$2: $scene" "other bytes" "none" "**FAIL**"
        fi
    done
}

# near NAME TITLE: every byte as released, or means of the channels that are off by no more than 1 in 1000, as much as a few
# paths that take another turn can do.
near() {
    for scene in $scenes; do
        if cmp -s "$work/release-$scene.exr" "$work/$1-$scene.exr"; then
            row "$2: $scene" "the same bytes" "1e-3 of mean" pass
            continue
        fi
        ratios=$(target/release/examples/etendue compare "$work/$1-$scene.exr" "$work/release-$scene.exr" --no-flip --json |
            tr -d ' \n' | sed -n 's/.*"ratio":\[\([^]]*\)\].*/\1/p')
        off=$(echo "$ratios" | tr , '\n' | awk '
            { off = $1 > 1 ? $1 - 1 : 1 - $1; if (off > worst) worst = off; n++ }
            END { if (n == 3) printf "%.1e", worst; else print 1 }')
        verdict=$(echo "$off" | awk '{ print $1 <= 1e-3 ? "pass" : "**FAIL**" }')
        row "$2: $scene" "mean off by $off" "1e-3 of mean" "$verdict"
    done
}

build release target --release
build dev target
export CARGO_PROFILE_DEV_OPT_LEVEL=0
build opt0 "$work/opt0"
unset CARGO_PROFILE_DEV_OPT_LEVEL
has_fma=0
if grep -q '^flags.* fma ' /proc/cpuinfo 2>/dev/null && grep -q '^flags.* avx2 ' /proc/cpuinfo; then
    has_fma=1
    RUSTFLAGS="-C target-feature=+avx2,+fma" build fma "$work/fma" --release
else
    skip "this processor has no AVX2 and fused multiply-add"
fi

# Embree chooses its kernels by the processor, and takes nothing from outside but what its host says at the start. So the
# call with which it is started is caught, and the choice added to it.
isas=
cat >"$work/isa.c" <<'SHIM'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

void *rtcNewDevice(const char *config) {
    void *(*next)(const char *) = (void *(*)(const char *))dlsym(RTLD_NEXT, "rtcNewDevice");
    const char *isa = getenv("EMBREE_ISA");
    char text[512];
    if (next == NULL || isa == NULL) {
        abort();
    }
    snprintf(text, sizeof text, "%s,isa=%s", config, isa);
    fprintf(stderr, "started with %s\n", text);
    return next(text);
}
SHIM
if ! "${CC:-cc}" -shared -fPIC -o "$work/isa.so" "$work/isa.c" -ldl; then
    skip "no C compiler to hold Embree to an instruction set"
else
    for pair in sse2: sse4.2:sse4_2 avx:avx avx2:avx2; do
        isa=${pair%:*}
        flag=${pair#*:}
        if [ -n "$flag" ] && ! grep -q "^flags.* $flag " /proc/cpuinfo; then
            skip "this processor has no $isa"
            continue
        fi
        say "rendering: Embree's $isa"
        LD_PRELOAD="$PWD/$work/isa.so" EMBREE_ISA=$isa render "$isa" target/release/examples/etendue 2>"$work/started"
        if grep -q "isa=$isa" "$work/started"; then
            isas="$isas $isa"
        else
            row "Embree's $isa" "it was not chosen" "" "**FAIL**"
        fi
    done
fi

printf '\n| %-48s | %-20s | %-12s | %s |\n|---|---|---|---|\n' "compared with the release build" "got" "tolerance" ""
same dev "in development (opt-level 2, checks on)"
same opt0 "not optimised (opt-level 0, checks on)"
[ $has_fma = 0 ] || near fma "AVX2 and fused multiply-add"
for isa in $isas; do
    near "$isa" "Embree held to $isa"
done
printf '\n%d failed, %d left out\n' "$failed" "$skipped"
[ "$failed" = 0 ]
