#!/bin/sh
# Installs what Étendue needs from Debian and is not there yet: Embree >= 4.3 with its header, libclang (bindgen reads
# the header with it), a C/C++ compiler and pkg-config. Says in one line what it installs and why. Changes nothing when
# all is there.
#
#   scripts/setup.sh          what rendering needs
#   scripts/setup.sh test     also what the C and C++ hosts are tested with: Clang, CMake, Doxygen, Valgrind; and the
#                             browser in which reports are opened (a download of 62 MiB, one minute); files of other programs
#                             that are read (23 MiB); Open MPI, for renders by several machines
#
# EMBREE_DIR=/prefix uses an Embree unpacked there and installs none.
set -eu

purpose=${1:-render}
case $purpose in
render | test) ;;
*) printf 'setup: expected render or test, not %s\n' "$purpose" >&2; exit 1 ;;
esac

say() { printf 'setup: %s\n' "$*"; }
die() { printf 'setup: %s\n' "$*" >&2; exit 1; }
have() { command -v "$1" >/dev/null 2>&1; }

packaged() { dpkg-query -W -f='${Status}' "$1" 2>/dev/null | grep -q 'ok installed'; }

# The header is what the library is built against, so the header's version decides.
embree_header() {
    if [ -n "${EMBREE_DIR:-}" ]; then
        set -- "$EMBREE_DIR/include"
    else
        set -- /usr/local/include /usr/include
    fi
    for dir; do
        [ -f "$dir/embree4/rtcore_config.h" ] && { printf '%s' "$dir/embree4/rtcore_config.h"; return; }
    done
    return 0
}
embree_ok() {
    header=$(embree_header)
    [ -n "$header" ] || return 1
    version=$(sed -n 's/^#define RTC_VERSION \([0-9]*\).*/\1/p' "$header")
    [ -n "$version" ] && [ "$version" -ge 40300 ]
}
libclang_ok() {
    [ -n "${LIBCLANG_PATH:-}" ] && return 0
    ldconfig -p 2>/dev/null | grep -q 'libclang[-.0-9]*\.so' && return 0
    for library in /usr/lib/llvm-*/lib/libclang.so* /usr/lib/llvm-*/lib/libclang-[0-9]*.so*; do
        [ -e "$library" ] && return 0
    done
    return 1
}

have cargo || die "Rust is missing: install it from https://rustup.rs, then run this again"

wanted=""
why=""
have cc && have c++ || { wanted="$wanted build-essential"; why="$why build-essential (C and C++ compiler);"; }
libclang_ok || { wanted="$wanted libclang-dev"; why="$why libclang-dev (bindgen reads Embree's header);"; }
have pkg-config || { wanted="$wanted pkg-config"; why="$why pkg-config;"; }
if [ "$purpose" = test ]; then
    have clang && have clang++ || { wanted="$wanted clang"; why="$why clang (a second compiler for the C and C++ hosts);"; }
    have cmake || { wanted="$wanted cmake"; why="$why cmake (how programs find the installed library);"; }
    have doxygen || { wanted="$wanted doxygen"; why="$why doxygen (the C and C++ reference);"; }
    have chromium-headless-shell || have chromium || [ -n "${CHROMIUM:-}" ] ||
        { wanted="$wanted chromium-headless-shell"; why="$why chromium-headless-shell (benchmark reports are opened in it);"; }
    [ -d /usr/share/assimp/models ] ||
        { wanted="$wanted assimp-testmodels"; why="$why assimp-testmodels (files of other programs that are read);"; }
    have valgrind || { wanted="$wanted valgrind libc6-dbg"; why="$why valgrind (memory errors of the hosts);"; }
fi
# Any MPI will do that is there already.
mpi_wanted=no
if [ "$purpose" = test ] && ! { have mpicc && have mpirun; }; then
    mpi_wanted=yes
    why="$why openmpi-bin, libopenmpi-dev (renders by several machines);"
fi
embree_wanted=no
if ! embree_ok; then
    [ -z "${EMBREE_DIR:-}" ] || die "EMBREE_DIR=$EMBREE_DIR holds no include/embree4 of version 4.3 or newer"
    embree_wanted=yes
    why="$why libembree-dev >= 4.3 (ray and mesh intersection);"
fi
[ -n "$wanted" ] || [ "$embree_wanted" = yes ] || [ "$mpi_wanted" = yes ] || exit 0

have apt-get || die "this machine lacks$why and has no apt-get: install them, or set EMBREE_DIR to an unpacked Embree"
as_root=""
if [ "$(id -u)" != 0 ]; then
    have sudo || die "this machine lacks$why installing them needs root: run 'scripts/setup.sh' as root once"
    as_root=sudo
fi
say "installing$why this takes about a minute"

# A lock held by another apt run is waited for, not failed on.
apt() { $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=300 "$@" >"$log" 2>&1 || { cat "$log" >&2; die "apt-get $* failed"; }; }
log=$(mktemp)
trap 'rm -f "$log"' EXIT

# After Embree, which has brought a newer libhwloc15 to a Debian 12: its companions then are those of the same release.
install_mpi() {
    set -- openmpi-bin libopenmpi-dev
    if ! $as_root apt-get -q -s install --no-install-recommends "$@" >/dev/null 2>&1; then
        set -- "$@" libhwloc-dev/trixie libhwloc-plugins/trixie
    fi
    apt install --no-install-recommends "$@"
}

$as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 update >"$log" 2>&1 || say "apt-get update had errors, going on with the lists there are"
# shellcheck disable=SC2086
[ -z "$wanted" ] || apt install --no-install-recommends $wanted

if [ "$embree_wanted" = yes ]; then
    candidate=$(apt-cache policy libembree-dev | sed -n 's/ *Candidate: //p')
    if dpkg --compare-versions "${candidate:-0}" ge 4.3; then
        apt install --no-install-recommends libembree-dev
    else
        # Debian 12 has Embree 3 only. The next release's package is taken from the mirror this machine already uses,
        # pinned low so that nothing else moves to it by itself.
        codename=$(. /etc/os-release && printf '%s' "${VERSION_CODENAME:-}")
        [ "$codename" = bookworm ] || die "this Debian offers Embree ${candidate:-none}, and 4.3 is needed: set EMBREE_DIR to an unpacked Embree"
        mirror=$(cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources 2>/dev/null |
            sed -n -e 's/^URIs: *\([^ ]*\/debian\)\/* *$/\1/p' -e 's/^deb  *\(\[[^]]*\] *\)\{0,1\}\([^ ]*\/debian\)\/*  *bookworm .*/\2/p' | head -n 1)
        [ -n "$mirror" ] || die "found no Debian mirror among the apt sources: set EMBREE_DIR to an unpacked Embree"
        keyring=/usr/share/keyrings/debian-archive-keyring.gpg
        printf 'Types: deb\nURIs: %s\nSuites: trixie\nComponents: main\nSigned-By: %s\n' "$mirror" "$keyring" |
            $as_root tee /etc/apt/sources.list.d/etendue-trixie.sources >/dev/null
        printf 'Package: *\nPin: release n=trixie\nPin-Priority: 100\n' |
            $as_root tee /etc/apt/preferences.d/etendue-trixie >/dev/null
        apt update
        apt install --no-install-recommends -t trixie libembree-dev
    fi
fi
embree_ok || die "libembree-dev was installed, but no header of version 4.3 or newer was found"
[ "$mpi_wanted" = no ] || install_mpi
