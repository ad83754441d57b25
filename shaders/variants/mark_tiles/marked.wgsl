// Tile mask, marked.
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
