#!/bin/sh
# Builds the web page into dist/, a folder of static files: plain cargo for wasm32-unknown-unknown, then wasm-bindgen. No wasm-opt, which makes
# what is sent larger (docs/decisions/026-size-of-the-page.md). The module of the page and that of the window are apart, so that a page with a
# picture alone stays small. What it needs: sh scripts/setup.sh --web
#
#   sh scripts/web.sh           builds dist/
#   sh scripts/web.sh --serve   builds it and serves it on http://localhost:8000
set -eu
cd "$(dirname "$0")/.."

case "${1:-}" in
    "" | --serve) ;;
    *)
        echo "usage: sh scripts/web.sh [--serve]" >&2
        exit 2
        ;;
esac

target="${CARGO_TARGET_DIR:-target}"
# All crates of the page as one compilation, which makes it smaller; that of the window would take many minutes.
CARGO_PROFILE_WEB_LTO=fat cargo build --profile web -p rasterlab-page --target wasm32-unknown-unknown
cargo build --profile web -p rasterlab-window --target wasm32-unknown-unknown

# The command must have the version of the crate; setup.sh installs it into the target folder.
wasm_bindgen="$target/web/bin/wasm-bindgen"
[ -x "$wasm_bindgen" ] || wasm_bindgen=wasm-bindgen
rm -rf dist
mkdir -p dist/presets dist/goldens
for module in page window; do
    "$wasm_bindgen" --target web --no-typescript --remove-name-section --remove-producers-section --out-dir dist "$target/wasm32-unknown-unknown/web/rasterlab_$module.wasm"
    wasm="dist/rasterlab_${module}_bg.wasm"
    printf '%s: %s bytes, %s as gzip\n' "$wasm" "$(wc -c < "$wasm")" "$(gzip -9 -c "$wasm" | wc -c)"
done
cp crates/page/web/* dist/
cp presets/*.toml dist/presets/
cp tests/snapshots/*.png dist/goldens/
# Ids and names of the gallery.
for preset in presets/*.toml; do
    sed -n "s/^name = \\(\".*\"\\)\$/[\"$(basename "$preset" .toml)\", \\1]/p;" "$preset" | head -n 1
done | paste -s -d , | sed 's/.*/[&]/' > dist/gallery.json

if [ "${1:-}" = --serve ]; then
    exec python3 -m http.server --bind localhost --directory dist 8000
fi
