#!/bin/sh
# The command-line program and a C host render the same scene: the files must be the same, byte by byte.
#
# Usage: same_bytes.sh COMMAND_LINE_PROGRAM C_HOST, in the repository's folder
set -eu
cli=$1
host=$2
scene=scenes/room.json
samples=2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
comments="scene $scene; integrator Path; samples per pixel $samples; sampler Sobol; filter Box; maximum depth none; \
shadow rays 1; seed 0"
"$cli" render "$scene" --spp $samples --quiet -o "$work/rust.png" "$work/rust.pfm" "$work/rust.exr"
"$cli" render "$scene" --spp $samples --quiet --checkpoint "$work/rust.film"
"$host" "$scene" $samples "$comments" "$work/c.png" "$work/c.pfm" "$work/c.exr" "$work/c.film"
for format in png pfm exr film; do
    cmp "$work/rust.$format" "$work/c.$format"
done
echo "png, pfm, exr and checkpoint of $scene are the same from Rust and from C"
