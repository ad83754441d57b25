#!/bin/sh
# Prints the table "moving scenes" of docs/benchmarks.md for one adapter: skins, particles, shadows, dots and culling, each with every option
# of its axis, milliseconds beside error.
#
#   sh scripts/moving_scenes.sh                      on the best adapter there is
#   sh scripts/moving_scenes.sh --adapter llvmpipe   on another; further arguments go to `rasterlab bench`
set -eu
cd "$(dirname "$0")/.."

lab="${RASTERLAB:-target/release/rasterlab}"
if ! [ -x "$lab" ]; then
    echo "moving_scenes: $lab is missing; cargo build --release makes it" >&2
    exit 1
fi

bench() {
    "$lab" bench --format md "$@"
}

bench --scene 'tentacle?tess=2&instances=1000' --set scene.clip=Sway --set clock.time_s=1.7 --axes skinning "$@"
for count in 100000 1000000; do
    bench particles --set particles.count=$count --set clock.time_s=0.25 --axes curl_noise,particle_storage "$@"
done
bench shadow --axes shadow_map_size,shadow_taps "$@"
for spacing_m in 0.00089 0.00016; do
    bench dots --set scene.builtin='knot?tess=16' --set dots.spacing_m=$spacing_m --axes dot_culling "$@"
done
bench --scene 'field?count=1000&triangles=10000' --axes culling "$@"
