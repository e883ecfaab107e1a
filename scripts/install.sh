#!/bin/sh
# Builds, installs and uninstalls what other programs and people use: the C library, its headers, what finds them
# (pkg-config, CMake), and the command line with its manual pages and completions.
#
#   scripts/install.sh build | install | uninstall
#
# PREFIX (/usr/local), LIBDIR (PREFIX/lib; the multiarch folder of the C compiler under /usr) and DESTDIR (a folder in
# which the whole is staged for packaging) say where. Files know PREFIX and never DESTDIR. What install put where, and the
# folders that it made, are listed in PREFIX/share/etendue/installed.txt; uninstall removes that and nothing else.
set -eu
cd "$(dirname "$0")/.."

die() { printf 'install: %s\n' "$*" >&2; exit 1; }

CARGO=${CARGO:-cargo}
CC=${CC:-cc}
PREFIX=${PREFIX:-/usr/local}
DESTDIR=${DESTDIR:-}
if [ -z "${LIBDIR:-}" ]; then
    LIBDIR=$PREFIX/lib
    multiarch=$("$CC" -print-multiarch 2>/dev/null || true)
    [ "$PREFIX" != /usr ] || [ -z "$multiarch" ] || LIBDIR=/usr/lib/$multiarch
fi
for folder in "$PREFIX" "$LIBDIR"; do
    case $folder in
    /*) ;;
    *) die "PREFIX and LIBDIR must be absolute, not $folder" ;;
    esac
done

# The version in Cargo.toml decides names: before 1.0 each minor version has an ABI of its own.
VERSION=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
MAJOR=${VERSION%%.*}
MINOR=${VERSION#*.}
MINOR=${MINOR%%.*}
if [ "$MAJOR" = 0 ]; then ABI=0.$MINOR; else ABI=$MAJOR; fi

TARGET=${CARGO_TARGET_DIR:-}
if [ -z "$TARGET" ] && command -v "$CARGO" >/dev/null 2>&1; then
    TARGET=$("$CARGO" metadata --no-deps --format-version 1 --offline | sed -n 's/.*"target_directory":"\([^"]*\)".*/\1/p')
fi
PROFILE=${ETENDUE_PROFILE:-release}
BUILT=${TARGET:-target}/$PROFILE
# The libraries as they were built here, of which cargo keeps others by the name of the target.
SHARED=$BUILT/libetendue.so
STATIC=$BUILT/libetendue.a
# What the static library needs of the system, as the compiler says.
NATIVE=$BUILT/etendue.native-static-libs
# What is made here from the build: the archive that shows nothing but the interface, and files that know their place.
STAGE=$BUILT/install

build() {
    # `make test` builds the program and the libraries with all features. The flags fall apart into words.
    # shellcheck disable=SC2086
    "$CARGO" build --profile "$PROFILE" --locked ${ETENDUE_FEATURES:-} --example etendue
    mkdir -p "$BUILT"
    # shellcheck disable=SC2086
    "$CARGO" rustc --profile "$PROFILE" --locked ${ETENDUE_FEATURES:-} --features capi --example etendue_c -- \
        -C "link-arg=-Wl,-soname,libetendue.so.$ABI" --print "native-static-libs=$NATIVE"
    # Any build of all examples replaces cargo's, by libraries without this name.
    cp -p "$BUILT/examples/libetendue_c.so" "$SHARED"
    cp -p "$BUILT/examples/libetendue_c.a" "$STATIC"
}

# Only etd_... stays visible in the archive. As rustc makes it, it shows the whole Rust runtime, which collides with that
# of any other Rust library in the same program. The groups are dissolved since a linker would take another library's
# copy of a group and leave this one's symbols, now local, without theirs.
archive() {
    ld -r --force-group-allocation --whole-archive "$STATIC" -o "$STAGE/etendue.o"
    objcopy --wildcard --keep-global-symbol='etd_*' --strip-debug --remove-section=.llvmbc --remove-section=.llvmcmd \
        --remove-section=.llvm_addrsig "$STAGE/etendue.o"
    rm -f "$STAGE/libetendue.a"
    ar rcs "$STAGE/libetendue.a" "$STAGE/etendue.o"
    rm "$STAGE/etendue.o"
}

# The templates in packaging/, filled in.
describe() {
    # The C compiler links libc by itself; a static program's Embree is found where this one's was.
    native=$(sed 's/-lc\b//g' "$NATIVE" | tr -s ' \n' '  ')
    native=${native% }
    native=${native# }
    if [ -n "${EMBREE_DIR:-}" ]; then
        for folder in lib lib64 lib/x86_64-linux-gnu lib/aarch64-linux-gnu; do
            [ -e "$EMBREE_DIR/$folder/libembree4.so" ] || continue
            native="-L$EMBREE_DIR/$folder -Wl,-rpath,$EMBREE_DIR/$folder $native"
            break
        done
    fi
    # A CMake list; the linker's own options stay one item each.
    list=$(printf '%s' "$native" | tr ' ' ';')
    up=$(realpath -ms --relative-to="$LIBDIR/cmake/etendue" "$PREFIX")
    from=$(realpath -ms --relative-to="$PREFIX" "$LIBDIR")
    for file in etendue.pc etendue-static.pc etendueConfig.cmake etendueConfigVersion.cmake; do
        sed -e "s|@PREFIX@|$PREFIX|g; s|@LIBDIR@|$LIBDIR|g; s|@VERSION@|$VERSION|g; s|@ABI@|$ABI|g" \
            -e "s|@NATIVE@|$native|g; s|@NATIVE_LIST@|$list|g; s|@UP@|$up|g; s|@LIB@|$from|g" \
            "packaging/$file.in" >"$STAGE/$file"
    done
}

# Everything that is installed: mode|where it comes from|where it goes; "link" with its target for a link.
files() {
    cat <<END
755|$BUILT/examples/etendue|$PREFIX/bin/etendue
755|$SHARED|$LIBDIR/libetendue.so.$VERSION
link|libetendue.so.$VERSION|$LIBDIR/libetendue.so.$ABI
link|libetendue.so.$ABI|$LIBDIR/libetendue.so
644|$STAGE/libetendue.a|$LIBDIR/libetendue.a
644|$STAGE/etendue.pc|$LIBDIR/pkgconfig/etendue.pc
644|$STAGE/etendue-static.pc|$LIBDIR/pkgconfig/etendue-static.pc
644|$STAGE/etendueConfig.cmake|$LIBDIR/cmake/etendue/etendueConfig.cmake
644|$STAGE/etendueConfigVersion.cmake|$LIBDIR/cmake/etendue/etendueConfigVersion.cmake
END
    for header in include/*; do echo "644|$header|$PREFIX/include/${header##*/}"; done
    for page in docs/man/*.1; do echo "644|$page|$PREFIX/share/man/man1/${page##*/}"; done
    cat <<END
644|packaging/completions/etendue.bash|$PREFIX/share/bash-completion/completions/etendue
644|packaging/completions/_etendue|$PREFIX/share/zsh/vendor-completions/_etendue
644|packaging/completions/etendue.fish|$PREFIX/share/fish/vendor_completions.d/etendue.fish
END
}

MANIFEST=$PREFIX/share/etendue/installed.txt

# Makes the folder of a file, and notes each one that was not there.
folder() {
    [ -d "$DESTDIR$1" ] && return
    folder "$(dirname "$1")"
    mkdir "$DESTDIR$1"
    echo "folder $1" >>"$list"
}

# Removes what a list names, newest first, so that folders are empty when their turn comes; others' files keep theirs.
remove() {
    tac "$1" | while read -r kind path; do
        case $kind in
        file) rm -f "$DESTDIR$path" ;;
        folder) rmdir "$DESTDIR$path" 2>/dev/null || true ;;
        esac
    done
}

# The loader's table, where this install is for this very machine and in one of the loader's folders.
refresh_loader() {
    [ -z "$DESTDIR" ] && [ "$(id -u)" = 0 ] || return 0
    ldconfig -v -N -X 2>/dev/null | grep -q "^$LIBDIR:" && ldconfig
    return 0
}

install_all() {
    { [ -f "$SHARED" ] && [ -f "$NATIVE" ]; } || die "nothing was built yet: run 'make build' first"
    mkdir -p "$STAGE"
    archive
    describe
    # What an earlier install put there goes first, since this one may put less; folders that stay remain its own.
    list=$(mktemp)
    trap 'rm -f "$list"' EXIT
    folders=$(sed -n 's/^folder //p' "$DESTDIR$MANIFEST" 2>/dev/null || true)
    uninstall_all quietly
    printf '%s\n' "$folders" | while read -r path; do
        if [ -n "$path" ] && [ -d "$DESTDIR$path" ]; then echo "folder $path" >>"$list"; fi
    done
    if [ -n "$DESTDIR" ]; then mkdir -p "$DESTDIR"; fi
    folder "$(dirname "$MANIFEST")"
    echo "file $MANIFEST" >>"$list"
    files | while IFS='|' read -r mode from to; do
        folder "$(dirname "$to")"
        case $mode in
        link) ln -sf "$from" "$DESTDIR$to" ;;
        *) install -m "$mode" "$from" "$DESTDIR$to" ;;
        esac
        case $mode in 755) strip --strip-debug "$DESTDIR$to" ;; esac
        echo "file $to" >>"$list"
    done
    install -m 644 "$list" "$DESTDIR$MANIFEST"
    refresh_loader
    echo "installed etendue $VERSION in $DESTDIR$PREFIX (libraries in $LIBDIR)"
}

uninstall_all() {
    if [ ! -f "$DESTDIR$MANIFEST" ]; then
        [ "${1:-}" = quietly ] || echo "no etendue is installed in $DESTDIR$PREFIX"
        return 0
    fi
    old=$(mktemp)
    cp "$DESTDIR$MANIFEST" "$old"
    remove "$old"
    rm "$old"
    [ "${1:-}" = quietly ] || { refresh_loader; echo "removed etendue from $DESTDIR$PREFIX"; }
}

case ${1:-} in
build) build ;;
install) install_all ;;
uninstall) uninstall_all ;;
*) die "expected build, install or uninstall" ;;
esac
