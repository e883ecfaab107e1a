#!/bin/sh
# Every check of the project, cheapest first. Stops at the first that fails.
set -eu
cd "$(dirname "$0")/.."

step() { printf '\n== %s\n' "$*"; }

# One build serves lints, tests and what is installed (`profile.checked` in Cargo.toml). With ETENDUE_LTO set, as it is to be before a
# release, what is installed is built and tried as it is released.
installed() {
    if [ -n "${ETENDUE_LTO:-}" ]; then "$@"; else env ETENDUE_PROFILE=checked ETENDUE_FEATURES=--all-features "$@"; fi
}

step "formatting"
cargo fmt --all --check

step "lints"
cargo clippy --profile checked --locked --all-targets --all-features -- -D warnings
# As people build the program, and the libraries.
cargo clippy --profile checked --locked --lib --example etendue -- -D warnings
cargo clippy --profile checked --locked --features capi --example etendue_c -- -D warnings

step "tests"
cargo test --profile checked --locked --all-features

step "documentation"
# With an example, dependencies are those that the lints were given: nothing of them is checked once more.
RUSTDOCFLAGS="-D warnings" cargo doc --profile checked --locked --no-deps --all-features --lib --example million_triangles

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
