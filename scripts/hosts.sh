#!/bin/sh
# Builds every C and C++ example and test against an installed Étendue, as strangers would, and runs them.
#
# Usage: scripts/hosts.sh PREFIX
#   with gcc and clang, C99, C++17 and C++20, by pkg-config and by CMake; then under AddressSanitizer and UBSan, under
#   ThreadSanitizer, and under valgrind. What is not installed is left out, with a line that says so; REQUIRE_ALL=1 makes
#   that an error. ETENDUE_CLI: the command-line program to compare images with (default: that of PREFIX).
set -eu
cd "$(dirname "$0")/.."
root=$PWD
prefix=${1:?usage: scripts/hosts.sh PREFIX}
prefix=$(cd "$prefix" && pwd)
work=$(mktemp -d)
watched=
# Ends what runs in the background, says what it said, and cleans up.
leave() {
    if [ -n "$watched" ]; then
        kill "$watched" 2>/dev/null || true
        wait "$watched" 2>/dev/null || true
        tail -n 60 "$work/valgrind/report" >&2
    fi
    rm -rf "$work"
}
trap leave EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP
export PKG_CONFIG_PATH="$prefix/lib/pkgconfig" CMAKE_PREFIX_PATH="$prefix"
export LD_LIBRARY_PATH="$prefix/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
strict="-Wall -Wextra -Wpedantic -Werror"
strict_cpp="$strict -Wshadow -Wconversion"
begin=$(date +%s)
skipped=0

say() {
    printf '== %4d s  %s\n' $(($(date +%s) - begin)) "$*"
}

skip() {
    echo "!! SKIPPED: $*" >&2
    skipped=$((skipped + 1))
    if [ "${REQUIRE_ALL:-0}" = 1 ]; then
        echo "!! REQUIRE_ALL=1: that is an error" >&2
        exit 1
    fi
}

has() {
    command -v "$1" >/dev/null 2>&1
}

# Runs a program quietly; what it said is shown when it fails.
run() {
    if ! "$@" >"$work/output" 2>&1; then
        echo "failed: $*" >&2
        tail -n 60 "$work/output" >&2
        exit 1
    fi
}

# build FOLDER NAME [VARIABLE=VALUE...]: makes all of a folder in $work/NAME.
build() {
    from=$1
    to=$2
    shift 2
    run make -j2 -C "$from" BUILD="$work/$to" "$@"
}

# Runs the examples that are in this folder, with small images, in a folder of their own.
run_examples() {
    bin=$work/$1
    mkdir -p "$bin/run"
    cd "$bin/run"
    run "$bin/minimal" "$root/scenes/cornell.json" minimal.png 1
    run "$bin/build_scene" build_scene.png 32 24 2
    run "$bin/build_scene" cancelled.png 32 24 1000000 0.2
    run "$bin/orbit" 3 24 16 2
    run "$bin/thread_pool" 3 24 16 2
    if [ -x "$bin/two_devices" ]; then
        run "$bin/two_devices" 24 16 2
        run "$bin/pick" "$root/scenes/cornell.json" 12
        run "$bin/bake" bake.ppm 32 4
        if [ ! -s bake.ppm ]; then
            echo "failed: $bin wrote no bake.ppm" >&2
            exit 1
        fi
        # Where Open Image Denoise is not installed, the noisy image is all that it writes. The TBB that comes with it loads parts
        # of itself in a way (RTLD_DEEPBIND) that AddressSanitizer refuses.
        case $1 in
            asan-*) run "$bin/denoise" --samples 2 --size 24 16 --oidn none ;;
            *) run "$bin/denoise" --samples 2 --size 24 16 ;;
        esac
        if [ ! -s denoise-noisy.png ]; then
            echo "failed: $bin wrote no denoise-noisy.png" >&2
            exit 1
        fi
    fi
    if [ -x "$bin/viewer" ]; then
        run "$bin/viewer" 24 16 8 2
    fi
    run "$bin/pick"
    for image in minimal build_scene cancelled orbit-002 thread_pool; do
        if [ ! -s "$image.png" ]; then
            echo "failed: $bin wrote no $image.png" >&2
            exit 1
        fi
    done
    cd "$root"
}

# Runs the tests that are in this folder, all but that of memory that runs out.
run_tests() {
    bin=$work/$1
    mkdir -p "$bin/run"
    cd "$bin/run"
    run "$bin/misuse"
    run "$bin/async" 5
    run "$bin/process"
    run "$bin/materials"
    run "$bin/textures"
    run "$bin/checkpoint"
    run "$bin/layer"
    run "$bin/layer_returning"
    cd "$root"
}

# Valgrind knows one processor and takes longest: beside all that follows, with the programs of the first compiler.
watch() {
    say "valgrind, with $cc's programs, in the background"
    memcheck="valgrind --quiet --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite,indirect,possible"
    memcheck="$memcheck --suppressions=$root/tests/capi/valgrind.supp"
    mkdir -p "$work/valgrind"
    cat >"$work/valgrind/tiny.json" <<'SCENE'
{"etendue": 1, "render": {"resolution": [8, 6], "samples": 1},
 "camera": {"origin": [0, 0, 4], "lookAt": [0, 0, 0], "up": [0, 1, 0], "fieldOfView": 60},
 "surfaces": [{"geometry": "sphere", "origin": [0, 0, 0], "radius": 1, "emission": [1, 1, 1]}]}
SCENE
    (
        child=
        trap '[ -z "$child" ] || kill "$child" 2>/dev/null; exit 143' TERM
        cd "$work/valgrind"
        $memcheck "$work/$cc-c/minimal" tiny.json tiny.png &
        child=$!
        wait "$child"
        $memcheck "$work/$cc-tests/misuse" --quick &
        child=$!
        wait "$child"
    ) >"$work/valgrind/report" 2>&1 &
    watched=$!
}

say "the binary interface"
run tests/capi/abi.sh "$prefix/include/etendue.h" "$prefix/lib/libetendue.so"

compilers=
for pair in gcc:g++ clang:clang++; do
    if has "${pair%:*}" && has "${pair#*:}"; then
        compilers="$compilers $pair"
    else
        skip "${pair%:*} is not installed"
    fi
done
for pair in $compilers; do
    cc=${pair%:*}
    cxx=${pair#*:}
    say "$cc: headers by themselves"
    for standard in c99 c11 c17; do
        echo '#include <etendue.h>' >"$work/alone.c"
        run "$cc" -std=$standard $strict -I"$prefix/include" -fsyntax-only "$work/alone.c"
    done
    for standard in c++17 c++20; do
        for header in etendue.h etendue.hpp; do
            echo "#include <$header>" >"$work/alone.cpp"
            run "$cxx" -std=$standard $strict_cpp -I"$prefix/include" -fsyntax-only "$work/alone.cpp"
            run "$cxx" -std=$standard $strict_cpp -fno-exceptions -I"$prefix/include" -fsyntax-only "$work/alone.cpp"
        done
    done
    say "$cc: tests and examples by pkg-config"
    build tests/capi "$cc-tests" CC="$cc" CXX="$cxx"
    build examples/c "$cc-c" CC="$cc" CFLAGS="-O2 $strict"
    if [ -z "$watched" ] && has valgrind; then
        watch
    fi
    build examples/cpp "$cc-cpp" CXX="$cxx" CXXFLAGS="-std=c++17 -O2 $strict_cpp"
    build examples/cpp "$cc-cpp20" CXX="$cxx" CXXFLAGS="-std=c++20 -O1 $strict_cpp"
    run_tests "$cc-tests"
    run_examples "$cc-c"
    run_examples "$cc-cpp"
done
if [ -z "$compilers" ]; then
    echo "no compiler is installed" >&2
    exit 1
fi
first=${compilers# }
first=${first%% *}
cc=${first%:*}
cxx=${first#*:}

# The library's matter, whoever compiled its host. Sanitizers need all addresses themselves.
say "memory that runs out"
cd "$work/$cc-tests/run"
run "$work/$cc-tests/memory"
cd "$root"

say "the same bytes as from Rust"
cli=${ETENDUE_CLI:-$prefix/bin/etendue}
if [ -x "$cli" ]; then
    run tests/capi/same_bytes.sh "$cli" "$work/$cc-tests/same_bytes"
else
    skip "images are not compared with those of the command-line program: there is no $cli"
fi

if has cmake; then
    say "tests and examples by CMake"
    for folder in examples/c examples/cpp tests/capi; do
        to=$work/cmake/$folder
        run cmake -S "$folder" -B "$to" -DCMAKE_BUILD_TYPE=Release
        run cmake --build "$to" --parallel 2
    done
    run_examples cmake/examples/c
    run_examples cmake/examples/cpp
    run "$work/cmake/tests/capi/layer"
else
    skip "cmake is not installed"
fi

# Clang may be there without its sanitizers' libraries.
for pair in $compilers ''; do
    if [ -z "$pair" ]; then
        skip "no compiler has sanitizers"
    elif echo 'int main(void) { return 0; }' | "${pair%:*}" -x c -fsanitize=address,undefined - -o "$work/probe" \
        >"$work/output" 2>&1 && "$work/probe"; then
        break
    fi
done
checked_by=$pair

# The Rust library is not instrumented: the sanitizers watch the hosts, and every allocation, which both have in common.
# So overruns are found in the hosts and in what the C library does for either, leaks in both.
if [ -n "$checked_by" ]; then
    san_cc=${checked_by%:*}
    san_cxx=${checked_by#*:}
    say "AddressSanitizer and UBSan, with $san_cc"
    sanitize="-g -O1 -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=all"
    export ASAN_OPTIONS=detect_stack_use_after_return=1
    build tests/capi asan-tests CC="$san_cc" CXX="$san_cxx" CFLAGS="$sanitize" CXXFLAGS="-std=c++17 $sanitize"
    build examples/c asan-c CC="$san_cc" CFLAGS="$sanitize $strict"
    build examples/cpp asan-cpp CXX="$san_cxx" CXXFLAGS="-std=c++17 $sanitize $strict_cpp"
    run_tests asan-tests
    run_examples asan-c
    run_examples asan-cpp

    # ThreadSanitizer sees of the library only what it asks of pthreads (threads that begin and are joined), not its locks:
    # they are futexes of Rust's own. async.c says where the order of the host's memory rests on those.
    say "ThreadSanitizer, with $san_cc"
    mkdir -p "$work/tsan"
    # shellcheck disable=SC2046,SC2086 # flags are words
    run "$san_cc" -std=c99 $strict -g -O1 -fsanitize=thread -pthread $(pkg-config --cflags etendue) tests/capi/async.c \
        $(pkg-config --libs etendue) -o "$work/tsan/async"
    run env TSAN_OPTIONS="suppressions=$root/tests/capi/tsan.supp halt_on_error=1" "$work/tsan/async" 5
fi

if [ -n "$watched" ]; then
    say "valgrind, to its end"
    status=0
    wait "$watched" || status=$?
    watched=
    if [ "$status" != 0 ]; then
        echo "failed: valgrind, status $status" >&2
        tail -n 60 "$work/valgrind/report" >&2
        exit 1
    fi
else
    skip "valgrind is not installed"
fi

say "done; $skipped left out"
