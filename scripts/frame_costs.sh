#!/bin/sh
# Prints the first table of docs/benchmarks.md for one adapter: meshes of 840 to 4 million triangles and soups of many layers, with every option of
# visibility and the baselines in turn, milliseconds beside error.
#
#   sh scripts/frame_costs.sh                      on the best adapter there is
#   sh scripts/frame_costs.sh --adapter llvmpipe   on another; further arguments go to `rasterlab bench`
#   SPHERES="1000000" sh scripts/frame_costs.sh    with other spheres than 10^4, 10^5, 10^6 and 4 * 10^6 triangles
set -eu
cd "$(dirname "$0")/.."

lab="${RASTERLAB:-target/release/rasterlab}"
if ! [ -x "$lab" ]; then
    echo "frame_costs: $lab is missing; cargo build --release makes it" >&2
    exit 1
fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 scripts/raster_scenes.py "$folder" >/dev/null

meshes=""
for triangles in ${SPHERES:-10000 100000 1000000 4000000}; do
    meshes="$meshes --scene sphere?triangles=$triangles"
done
soups=""
for file in "$folder"/*.glb; do
    case "$file" in
        *soup*) soups="$soups --scene $file" ;;
        *) meshes="$meshes --scene $file" ;;
    esac
done

# Both are lists of words.
# shellcheck disable=SC2086
"$lab" bench $meshes --format md "$@"
# shellcheck disable=SC2086
"$lab" bench $soups --set 'camera.eye=[0,0,3]' --set 'camera.target=[0,0,0]' --set camera.fov_y_deg=38 --format md "$@"
