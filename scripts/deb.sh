#!/bin/sh
# Makes a Debian package of what `make install` installs, in target/debian: library, headers, command line in one.
# What it depends on is read from the binaries.
set -eu
cd "$(dirname "$0")/.."

version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
architecture=$(dpkg --print-architecture)
out=$PWD/target/debian
root=$out/root
rm -rf "$out"
mkdir -p "$root/DEBIAN" "$root/usr/share/doc/etendue" "$out/debian"

make --no-print-directory install PREFIX=/usr LIBDIR= DESTDIR="$root"
# dpkg keeps a list of its own.
rm -r "$root/usr/share/etendue"
for page in "$root"/usr/share/man/man1/*.1; do gzip -9n "$page"; done
cat LICENSE LICENSE-MIT LICENSE-APACHE src/emitter/hosek_wilkie/LICENSE >"$root/usr/share/doc/etendue/copyright"

library=$(ls "$root"/usr/lib/*/libetendue.so."$version")
# dpkg-shlibdeps wants to stand beside a debian/control; that the library in the package itself needs none is said to it.
printf 'Source: etendue\n\nPackage: etendue\nArchitecture: any\n' >"$out/debian/control"
depends=$(cd "$out" && dpkg-shlibdeps -O --ignore-missing-info -l"$(dirname "$library")" \
    "$root/usr/bin/etendue" "$library" | sed -n 's/^shlibs:Depends=//p')
size=$(du -sk --exclude=DEBIAN "$root" | cut -f 1)
cat >"$root/DEBIAN/control" <<END
Package: etendue
Version: $version-1
Section: graphics
Priority: optional
Architecture: $architecture
Maintainer: ${DEBFULLNAME:-The Étendue developers} <${DEBEMAIL:-root@localhost}>
Installed-Size: $size
Depends: $depends
Suggests: pkg-config, cmake
Description: physically based rendering for programs that link a renderer
 A library for C, C++ and Rust: Embree finds what a ray meets, everything else,
 materials, lights, sampling and transport, is done here. Holds the shared
 library, the archive, the headers for C and C++, files for pkg-config and
 CMake, and the command etendue.
END
echo "activate-noawait ldconfig" >"$root/DEBIAN/triggers"
dpkg-deb --root-owner-group --build "$root" "$out/etendue_$version-1_$architecture.deb" >/dev/null
rm -r "$root" "$out/debian"
echo "$out/etendue_$version-1_$architecture.deb: $depends"
