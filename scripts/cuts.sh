#!/bin/sh
# Renders that are cut at random come to the bytes of one that is not: killed and gone on from with other numbers of threads and
# processes, and merged from parts. Then a render is killed while it writes checkpoints, which must stay readable. Prints what it does.
#
#   scripts/cuts.sh [NUMBER OF CUT RENDERS] [NUMBER OF KILLS IN WRITES]     40 and 50 by default; about a quarter of an hour
#
# ETENDUE and ETENDUE_MPI are the programs; without ETENDUE_MPI, no render is one of several processes. SEED chooses the cuts.
set -eu
cd "$(dirname "$0")/.."

cuts=${1:-40}
kills=${2:-50}
seed=${SEED:-1}
etendue=${ETENDUE:-target/release/examples/etendue}
mpi=${ETENDUE_MPI:-target/release/examples/etendue-mpi}
etendue=$(realpath "$etendue")
mpi=$([ -x "$mpi" ] && realpath "$mpi" || true)
scenes=$(pwd)/scenes
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
export OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_MCA_hwloc_base_binding_policy=none

# A number from 0 to $1 - 1.
below() {
    seed=$(awk -v seed="$seed" 'BEGIN { print (seed * 16807) % 2147483647 }')
    random=$((seed % $1))
}

methods="path whitted sppm photon irradiance_cache adaptive"
options() {
    case $1 in
    path) echo "$scenes/room.json --spp 256 --resolution 120x90 --integrator path" ;;
    whitted) echo "$scenes/mirrors-and-glass.json --spp 512 --resolution 120x90 --integrator whitted" ;;
    sppm) echo "$scenes/caustic-glass.json --spp 128 --resolution 120x90 --integrator sppm --photons 10000" ;;
    photon) echo "$scenes/cornell.json --spp 256 --resolution 120x90 --integrator photon --photons 50000" ;;
    irradiance_cache) echo "$scenes/cornell.json --spp 512 --resolution 120x90 --integrator irradiance_cache" ;;
    adaptive) echo "$scenes/materials.json --spp 192 --resolution 120x90 --adaptive" ;;
    esac
}
for method in $methods; do
    # shellcheck disable=SC2046
    "$etendue" render $(options "$method") -o "$method.pfm" --quiet
done

# Chooses a number of threads or processes for the next go: sets `launch` and `threads`, and adds to `how`.
choose() {
    below 3
    if [ -n "$mpi" ] && [ "$random" = 0 ]; then
        below 3
        launch="mpirun -n $((random + 2)) $mpi"
        threads=1
        how="$how by $((random + 2)) processes"
    else
        below 4
        launch=$etendue
        threads=$((random + 1))
        how="$how by $threads threads"
    fi
}

# Goes on from the last checkpoint with $launch.
go_on() {
    again=$([ -e state ] && echo "--resume state" || true)
    # shellcheck disable=SC2046,SC2086
    exec $launch render $(options "$method") --threads "$threads" -o cut.pfm --quiet --checkpoint state --checkpoint-every 0.1 $again
}

# Kills a process and what it has started.
end() {
    pkill -9 -P "$1" 2>/dev/null || true
    kill -9 "$1" 2>/dev/null || true
    wait "$1" 2>/dev/null || true
}

number=0
for place in $(seq "$cuts"); do
    method=$(echo $methods | cut -d ' ' -f $(((place - 1) % 6 + 1)))
    rm -rf cut.pfm state part-* .etendue-*
    how=
    below 4
    if [ "$random" = 0 ] && [ "$method" != adaptive ]; then
        below 6
        count=$((random + 2))
        how=" merged from $count parts"
        for part in $(seq $count); do
            below 3
            # shellcheck disable=SC2046
            "$etendue" render $(options "$method") --share "$part/$count" --checkpoint "part-$part" --threads $((random + 1)) --quiet
        done
        # shellcheck disable=SC2046
        "$etendue" merge $(for part in $(seq $count); do below 1000; echo "$random part-$part"; done | sort -n | cut -d ' ' -f 2) \
            -o cut.pfm --quiet
    else
        for _ in 1 2 3 4; do
            choose
            (go_on) 2>messages &
            child=$!
            below 250
            sleep "$((random / 100)).$(printf %02d $((random % 100)))"
            kill -0 $child 2>/dev/null || break
            end $child
            how="$how, killed,"
            [ ! -e cut.pfm ] || break
        done
        if [ ! -e cut.pfm ]; then
            choose
            (go_on)
        fi
    fi
    cmp cut.pfm "$method.pfm" || { echo "$method$how: other bytes"; exit 1; }
    number=$((number + 1))
    echo "$number $method$how: the same bytes"
done

failures=0
for place in $(seq "$kills"); do
    rm -rf .etendue-*
    again=$([ -e written ] && echo "--resume written" || true)
    # shellcheck disable=SC2086
    "$etendue" render "$scenes/cornell.json" --resolution 900x700 --spp 100000 --checkpoint written --checkpoint-every 0.01 --quiet $again &
    child=$!
    while [ ! -e written ]; do sleep 0.05; done
    below 100
    sleep "1.$(printf %02d "$random")"
    end $child
    # shellcheck disable=SC2012
    [ -n "$(ls -d .etendue-* 2>/dev/null)" ] && in_writing=$((${in_writing:-0} + 1))
    "$etendue" merge written -o written.pfm --quiet || failures=$((failures + 1))
done
echo "$kills kills while checkpoints were written, ${in_writing:-0} of them in the middle of one: $failures unreadable"
[ "$failures" = 0 ]
