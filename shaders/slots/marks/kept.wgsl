// Marks, kept: remembers which 8x8 tiles of the picture a triangle's box touches, so that the resolve visits only those.
// A CPU adapter executes both sides of every branch, so an empty pixel costs it as much as a full one.
//@ use common/frame

@group(0) @binding(13) var<storage, read_write> tile_mask: array<atomic<u32>>;

// Marks the tiles under a box of pixels (first and last, inclusive, inside the picture).
fn marks_box(pixels: vec4i) {
    let tiles = vec4u(pixels / 8);
    let width = (frame.size.x + 7u) / 8u;
    for (var y = tiles.y; y <= tiles.w; y += 1u) {
        for (var x = tiles.x; x <= tiles.z; x += 1u) {
            atomicStore(&tile_mask[y * width + x], 1u);
        }
    }
}
