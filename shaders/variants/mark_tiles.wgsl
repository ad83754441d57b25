// Tile mask: which tiles of 8x8 pixels a triangle's box touches, given its first and last pixel inside the picture.
// Chosen on CPU adapters, which execute both sides of every branch, so that an empty pixel costs them as much as a full one.
// Without it, the resolve pass visits every pixel.
//@ steps fn mark_tiles(pixels: vec4i)

//@ step marked
//@ use lib/frame
//@ use lib/tile_mask

@group(0) @binding(13) var<storage, read_write> tile_mask: array<atomic<u32>>;

fn mark_tiles_marked(pixels: vec4i) {
    let tiles = vec4u(pixels / 8);
    let width = (frame.size.x + 7u) / 8u;
    for (var y = tiles.y; y <= tiles.w; y += 1u) {
        for (var x = tiles.x; x <= tiles.z; x += 1u) {
            atomicStore(&tile_mask[y * width + x], TILE_DRAWN);
        }
    }
}
