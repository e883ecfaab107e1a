#!/bin/sh
# Every check of the project, cheapest first. Stops at the first that fails.
set -eu
cd "$(dirname "$0")/.."

step() { printf '\n== %s\n' "$*"; }

# One build serves lints, tests and what is installed: a release's, with every check of arithmetic left on, which costs the tests no
# time, optimised as in development. It has no link-time optimisation and parts of the crate are compiled by themselves, which is half of the
# time that a release's build takes. It has a folder of its own. With ETENDUE_LTO set, as it is to be before a release, what is installed is
# built and tried as it is released.
folder=${CARGO_TARGET_DIR:-$PWD/target}/checked
checked() {
    env CARGO_TARGET_DIR="$folder" CARGO_PROFILE_RELEASE_DEBUG_ASSERTIONS=true CARGO_PROFILE_RELEASE_OVERFLOW_CHECKS=true \
        CARGO_PROFILE_RELEASE_DEBUG=none CARGO_PROFILE_RELEASE_OPT_LEVEL=2 CARGO_PROFILE_RELEASE_LTO=off \
        CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16 ETENDUE_FEATURES=--all-features "$@"
}
installed() {
    if [ -n "${ETENDUE_LTO:-}" ]; then "$@"; else checked "$@"; fi
}

step "formatting"
cargo fmt --all --check

step "lints"
checked cargo clippy --release --locked --all-targets --all-features -- -D warnings
# As people build the program.
checked cargo clippy --release --locked --lib --example etendue -- -D warnings

step "tests"
checked cargo test --release --locked --all-features

step "documentation"
# With an example, dependencies are those that the lints were given: nothing of them is checked once more.
checked env RUSTDOCFLAGS="-D warnings" cargo doc --release --locked --no-deps --all-features --lib --example million_triangles

if command -v shellcheck >/dev/null 2>&1; then
    step "scripts"
    # Flags from pkg-config are meant to fall apart into words.
    shellcheck --severity=warning --exclude=SC2046 scripts/*.sh
fi

step "faults that the accuracy suite is tried with"
scripts/mutations.pl --check

step "the program and the libraries"
installed make --no-print-directory build

step "a render, start to end"
installed make --no-print-directory render IMAGES="out/test.png out/test.exr" ARGS="--spp 16" >/dev/null
rm out/test.png out/test.exr

step "the same bytes from one thread and from two"
for threads in 1 2; do
    installed make --no-print-directory render IMAGES="out/threads$threads.exr" \
        ARGS="--resolution 100x75 --spp 16 --threads $threads --quiet" >/dev/null
done
cmp out/threads1.exr out/threads2.exr
rm out/threads1.exr out/threads2.exr

step "install, link, uninstall"
installed scripts/check_install.sh scripts/hosts.sh

step "the C and C++ reference"
mkdir -p target/doxygen
doxygen

step "links in the documents"
for document in *.md docs/*.md docs/design/*.md docs/history/*.md peers/*.md; do
    grep -o '](\([^)#: ]*\))' "$document" | sed 's/^](//; s/)$//' | while read -r link; do
        [ -e "$(dirname "$document")/$link" ] || { echo "$document: $link does not exist" >&2; exit 1; }
    done
done

printf '\nall checks passed\n'
