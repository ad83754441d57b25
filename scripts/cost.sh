#!/bin/sh
# Prints the table "cost of exactness" of docs/benchmarks.md for one adapter: every accuracy option alone beside the planned ones, in
# one interleaved run per scene, milliseconds beside error.
#
#   sh scripts/cost.sh                           on the best adapter there is
#   sh scripts/cost.sh --adapter llvmpipe       on another; further arguments go to `rasterlab bench`
#   TRIANGLES="1000 100000" sh scripts/cost.sh   on smaller scenes than 10^3, 10^5 and 10^7 triangles
set -eu
cd "$(dirname "$0")/.."

lab="${RASTERLAB:-target/release/rasterlab}"
if ! [ -x "$lab" ]; then
    echo "cost: $lab is missing; cargo build --release makes it" >&2
    exit 1
fi

scenes=""
for triangles in ${TRIANGLES:-1000 100000 10000000}; do
    scenes="$scenes --scene sphere?triangles=$triangles"
done

# $scenes is a list of words.
# shellcheck disable=SC2086
exec "$lab" bench $scenes --axes coverage,visibility,position_format,vertex_transform,depth,culling,shader_checks,parameters --each --format md "$@"
