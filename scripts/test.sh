#!/bin/sh
# Every check of the project, cheapest first. Stops at the first that fails.
set -eu
cd "$(dirname "$0")/.."

step() { printf '\n== %s\n' "$*"; }

# What is installed is built beside the lints and tests, of which long stretches leave a core idle. It yields to them, since
# some of them measure how soon a render stops. Link-time optimisation, which takes most of the time of a build, is left
# out unless ETENDUE_LTO is set, as it is to be before a release.
[ -n "${ETENDUE_LTO:-}" ] || export CARGO_PROFILE_RELEASE_LTO=off CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16
log=$(mktemp)
nice -n 19 make --no-print-directory build >"$log" 2>&1 &
optimised=$!
trap 'kill "$optimised" 2>/dev/null || true; rm -f "$log"' EXIT

step "formatting"
cargo fmt --all --check

step "lints"
cargo clippy --locked --all-targets --all-features -- -D warnings

step "tests"
cargo test --locked --all-features

step "documentation"
# With an example, dependencies are those that the lints were given: nothing of them is checked once more.
RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps --all-features --lib --example million_triangles

if command -v shellcheck >/dev/null 2>&1; then
    step "scripts"
    # Flags from pkg-config are meant to fall apart into words.
    shellcheck --severity=warning --exclude=SC2046 scripts/*.sh
fi

step "faults that the accuracy suite is tried with"
scripts/mutations.pl --check

step "the optimised build"
wait "$optimised" || { cat "$log" >&2; exit 1; }

step "a render, start to end"
make --no-print-directory render IMAGES="out/test.png out/test.exr" ARGS="--spp 16" >/dev/null
rm out/test.png out/test.exr

step "the same bytes from one thread and from two"
for threads in 1 2; do
    cargo run --quiet --release --locked --example etendue -- \
        render scenes/room.json --output "out/threads$threads.exr" --resolution 100x75 --spp 16 --threads "$threads" --quiet
done
cmp out/threads1.exr out/threads2.exr
rm out/threads1.exr out/threads2.exr

step "install, link, uninstall"
scripts/check_install.sh scripts/hosts.sh

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
