#!/bin/sh
# Installs the packages that building, drawing and testing need on Debian and Ubuntu: only missing ones, which it lists.
# A second run installs nothing.
#
#   sh scripts/setup.sh                 everything that cargo run and cargo test need
#   sh scripts/setup.sh --films         and ffmpeg, GNU parallel and Slurm, for videos and long films
#   sh scripts/setup.sh --swiftshader   and Chromium, whose libvk_swiftshader.so is a second Vulkan driver for the tests
#   sh scripts/setup.sh --web           and Chromium, Rust's target for pages and the wasm-bindgen command, for scripts/web.sh and tests/web
set -eu
cd "$(dirname "$0")/.."

swiftshader=no
films=no
web=no
for argument in "$@"; do
    case "$argument" in
        --swiftshader) swiftshader=yes ;;
        --films) films=yes ;;
        --web) web=yes ;;
        *)
            echo "usage: sh scripts/setup.sh [--films] [--swiftshader] [--web]" >&2
            exit 2
            ;;
    esac
done

# Does any of these files exist? The shell leaves a pattern without matches as it is.
exists() {
    for path in "$@"; do
        if [ -e "$path" ]; then return 0; fi
    done
    return 1
}

# The Vulkan loader.
packages="libvulkan1"

# A driver that runs on the CPU, unless a GPU and a driver are both here.
if ! exists /dev/nvidia0 /dev/dri/renderD* || ! exists /usr/share/vulkan/icd.d/*.json /etc/vulkan/icd.d/*.json; then
    packages="$packages mesa-vulkan-drivers"
fi

# Libraries that a window loads at run time: X11 and keyboards.
packages="$packages libx11-6 libx11-xcb1 libxcursor1 libxi6 libxrandr2 libxkbcommon0 libxkbcommon-x11-0"

# A screen for the window test where there is none, and models for the loader's tests.
packages="$packages xvfb xauth assimp-testmodels"

# The linker that rustc calls.
if ! command -v cc >/dev/null 2>&1; then
    packages="$packages gcc libc6-dev"
fi

if [ "$swiftshader" = yes ] || [ "$web" = yes ]; then
    packages="$packages chromium"
fi

if [ "$films" = yes ]; then
    packages="$packages ffmpeg parallel slurm-wlm munge"
fi

if ! command -v cargo >/dev/null 2>&1; then
    echo "setup: cargo is missing; https://rustup.rs installs Rust, of which 1.95 or newer is needed" >&2
    exit 1
fi

if [ "$web" = yes ]; then
    rustup target add wasm32-unknown-unknown
    # The command must have the version of the crate.
    folder="${CARGO_TARGET_DIR:-target}/web"
    version=$(sed -n '/^name = "wasm-bindgen"$/{n;s/version = "\(.*\)"/\1/p}' Cargo.lock)
    if [ "$("$folder/bin/wasm-bindgen" --version 2>/dev/null)" != "wasm-bindgen $version" ]; then
        cargo install --quiet wasm-bindgen-cli --version "=$version" --root "$folder"
    fi
fi

if ! command -v apt-get >/dev/null 2>&1; then
    echo "setup: no apt-get here, so nothing was installed. On Debian these would be needed:"
    echo "setup:   $packages"
    exit 0
fi

missing=""
for package in $packages; do
    status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
    if [ "$status" != installed ]; then missing="$missing $package"; fi
done

if [ -z "$missing" ]; then
    echo "setup: nothing is missing"
    exit 0
fi

as_root=""
if [ "$(id -u)" != 0 ]; then
    if ! command -v sudo >/dev/null 2>&1; then
        echo "setup: not root and no sudo; please install:$missing" >&2
        exit 1
    fi
    as_root="sudo"
fi

echo "setup: installing$missing"
$as_root apt-get update -q
# $missing is a list of words, which the shell must split.
# shellcheck disable=SC2086
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $missing
echo "setup: done"
