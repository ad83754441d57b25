#!/bin/sh
# Makes target/package/rasterlab_VERSION_ARCHITECTURE.deb: the program, its manual pages and completions, an entry in the menu of the desktop
# with an icon that the program draws, and the file types .glb, .gltf, .vrm, .obj, .stl, .ply and .rasterlab.toml.
#
#   sh scripts/package.sh                  builds the program with the profile dist and packs it
#   sh scripts/package.sh --binary FILE    packs a program that is built already, without its debug information
#   sh scripts/package.sh --try ...        also unpacks the package into an empty folder and runs the program from there
set -eu
cd "$(dirname "$0")/.."

binary=""
try=no
while [ $# -gt 0 ]; do
    case "$1" in
        --binary)
            binary=${2:?--binary needs a file}
            shift
            ;;
        --try) try=yes ;;
        *)
            echo "usage: sh scripts/package.sh [--binary FILE] [--try]" >&2
            exit 2
            ;;
    esac
    shift
done
for program in dpkg-deb dpkg gzip strip; do
    if ! command -v $program >/dev/null 2>&1; then
        echo "package: $program is missing; on Debian and Ubuntu: sudo apt install dpkg-dev binutils gzip" >&2
        exit 2
    fi
done

target=${CARGO_TARGET_DIR:-target}
if [ -z "$binary" ]; then
    cargo build --profile dist --locked
    binary=$target/dist/rasterlab
fi

version=$(sed -n 's/^version = "\(.*\)"$/\1/p' Cargo.toml | head -n 1)
architecture=$(dpkg --print-architecture)
root=$target/package/root
package=$target/package/rasterlab_${version}_$architecture.deb
rm -rf "$root" "$package"
share=$root/usr/share
mkdir -p "$root/usr/bin" "$root/DEBIAN" "$share/man/man1" "$share/applications" "$share/mime/packages" "$share/doc/rasterlab" \
    "$share/bash-completion/completions" "$share/zsh/vendor-completions" "$share/fish/vendor_completions.d"

strip -o "$root/usr/bin/rasterlab" "$binary"
chmod 755 "$root/usr/bin/rasterlab"
rasterlab=$root/usr/bin/rasterlab

"$rasterlab" man "$share/man/man1"
gzip -9n "$share"/man/man1/*.1
"$rasterlab" completions bash > "$share/bash-completion/completions/rasterlab"
"$rasterlab" completions zsh > "$share/zsh/vendor-completions/_rasterlab"
"$rasterlab" completions fish > "$share/fish/vendor_completions.d/rasterlab.fish"
for side in 48 128 256 512; do
    folder=$share/icons/hicolor/${side}x$side/apps
    mkdir -p "$folder"
    "$rasterlab" render scripts/package/icon.toml --adapter cpu --size "${side}x$side" --bare --quiet -o "$folder/rasterlab.png" >/dev/null
done
cp scripts/package/rasterlab.desktop "$share/applications/"
cp scripts/package/rasterlab.xml "$share/mime/packages/"
cp README.md "$share/doc/rasterlab/"
gzip -9nc CHANGELOG.md > "$share/doc/rasterlab/changelog.gz"
{
    printf 'Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n\nFiles: *\nCopyright: the authors of rasterlab\n'
    printf 'License: MIT or Apache-2.0\n\nLicense: MIT\n'
    sed 's/^$/./; s/^/ /' LICENSE-MIT
    printf '\nLicense: Apache-2.0\n On Debian systems the text is in /usr/share/common-licenses/Apache-2.0\n'
} > "$share/doc/rasterlab/copyright"

# What the program is linked with; the libraries of a window are loaded at run time.
libraries="libc6"
if command -v dpkg-shlibdeps >/dev/null 2>&1; then
    mkdir -p "$target/package/debian"
    printf 'Source: rasterlab\n\nPackage: rasterlab\nArchitecture: any\n' > "$target/package/debian/control"
    libraries=$(cd "$target/package" && dpkg-shlibdeps -O root/usr/bin/rasterlab 2>/dev/null | sed -n 's/^shlibs:Depends=//p')
fi
cat > "$root/DEBIAN/control" <<CONTROL
Package: rasterlab
Version: $version
Architecture: $architecture
Maintainer: the authors of rasterlab <rasterlab@localhost>
Section: graphics
Priority: optional
Installed-Size: $(du -sk --exclude=DEBIAN "$root" | cut -f 1)
Depends: $libraries, libvulkan1, libx11-6, libx11-xcb1, libxcursor1, libxi6, libxrandr2, libxkbcommon0, libxkbcommon-x11-0
Recommends: mesa-vulkan-drivers | vulkan-icd, hicolor-icon-theme, shared-mime-info
Suggests: ffmpeg, parallel, slurm-client
Description: effects lab around a triangle rasterizer
 Open a model (glTF, OBJ, STL, PLY), stack stylized effects on a rasterizer
 written as compute shaders, and save what you make as a preset that is also a
 test. Beside every picture stands what it cost and how wrong it is, against an
 exact CPU oracle.
CONTROL
(cd "$root" && find usr -type f -exec md5sum {} +) > "$root/DEBIAN/md5sums"
find "$root" -type d -exec chmod 755 {} +
find "$root/usr/share" "$root/DEBIAN" -type f -exec chmod 644 {} +
dpkg-deb --root-owner-group --build "$root" "$package" >/dev/null
echo "$package: $(stat -c %s "$package") bytes; the program: $(stat -c %s "$binary") bytes built, $(stat -c %s "$rasterlab") bytes packed"

if [ "$try" = no ]; then exit 0; fi
clean=$(mktemp -d)
trap 'rm -rf "$clean"' EXIT
dpkg-deb -x "$package" "$clean/root"
# Nothing of this folder or this person is there.
run() {
    (cd "$clean" && env -i HOME="$clean/home" PATH="$clean/root/usr/bin:/usr/bin:/bin" "$@")
}
mkdir "$clean/home"
run rasterlab --version
run rasterlab list presets --quiet >/dev/null
run rasterlab render teapot --adapter cpu --size 64x48 --quiet -o teapot.png >/dev/null
test -s "$clean/teapot.png"
for page in rasterlab rasterlab-sequence; do gzip -dc "$clean/root/usr/share/man/man1/$page.1.gz" | grep -q '^\.TH rasterlab'; done
if command -v desktop-file-validate >/dev/null 2>&1; then desktop-file-validate "$clean/root/usr/share/applications/rasterlab.desktop"; fi
if command -v update-mime-database >/dev/null 2>&1; then
    update-mime-database "$clean/root/usr/share/mime" >/dev/null
    grep -q 'rasterlab.toml' "$clean/root/usr/share/mime/globs2"
fi
echo "package: unpacked into an empty folder, it lists, draws and has its manual"
