#!/bin/sh
# Every check of the project, cheapest first. Stops at the first that fails.
set -eu
cd "$(dirname "$0")/.."

step() { printf '\n== %s\n' "$*"; }

step "formatting"
cargo fmt --all --check

step "lints"
cargo clippy --locked --all-targets --all-features -- -D warnings

step "tests"
cargo test --locked --all-features

step "documentation"
RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps --all-features

if command -v shellcheck >/dev/null 2>&1; then
    step "scripts"
    shellcheck scripts/*.sh
fi

step "a render, start to end"
make --no-print-directory render IMAGES="out/test.png out/test.exr" >/dev/null
cargo run --quiet --release --locked --example etendue -- compare out/test.exr out/test.exr --no-flip >/dev/null
rm -f out/test.png out/test.exr

printf '\nall checks passed\n'
