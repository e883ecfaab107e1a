#!/bin/sh
# The report's settings for photon maps (Section 3), with the error that its authors left out: time and relative MSE of
# path tracing, the report's map, paths with a caustic map, sppm and the irradiance cache, as a Markdown table.
#
# scripts/photon_table.sh ETENDUE REFERENCE [SCENE [SIZE]]: the command, and an image of SCENE (scenes/room.json) at
# SIZE x SIZE (256) to measure by. Best run with nothing else running.
set -eu
etendue=$1
reference=$2
scene=${3:-scenes/room.json}
size=${4:-256}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

row() { # label, options
    label=$1
    shift
    seconds=$("$etendue" render "$scene" --resolution "${size}x$size" --sampler grid --output "$work/x.exr" "$@" 2>&1 |
        sed -n 's/^done in \(.*\): .*samples per pixel.*/\1/p')
    error=$("$etendue" compare "$work/x.exr" "$reference" | sed -n 's/^relative mse *\([^ ]*\).*/\1/p')
    printf '| %s | %s | %s |\n' "$label" "$seconds" "$error"
}

printf '| 49 samples, 8 shadow rays, 10^6 photons | time | relative MSE |\n|---|---|---|\n'
set -- --spp 49 --shadow-rays 8 --photons 1000000
row "path tracing" --integrator path "$@"
row "the report's map, radius 0.1" --integrator photon_direct --photon-radius 0.1 "$@"
row "the report's map, radius 0.7" --integrator photon_direct --photon-radius 0.7 "$@"
row "paths and a caustic map" --integrator caustic --caustic-photons 1000000 "$@"
row "photon (final gathering)" --integrator photon --caustic-photons 1000000 "$@"
row "sppm, 10^6 light paths in all" --integrator sppm --spp 49 --shadow-rays 8 --photons 38000 --caustic-photons 38000
row "irradiance cache" --integrator irradiance_cache "$@"
