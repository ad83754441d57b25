// Adding triangles to the lists of the tiles that they may touch: first the lists are measured, then they are filled.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/shape
//@ use lib/tiles
//@ use lib/queued_triangle

@group(0) @binding(6) var<storage, read_write> bins: array<atomic<u32>>;

// The lists are filled; else they are measured.
override FILLS_LISTS: bool = false;

// Adds an entry to a tile's list. An entry that does not fit is dropped; the measured length still includes it.
fn tile_lists_add(tile: u32, entry: u32) {
    let slot = atomicAdd(&bins[tile], 1u);
    if FILLS_LISTS && slot < frame.bin_capacity { atomicStore(&bins[tiles_lists() + slot], entry); }
}

// As `edge_excludes`, in 32 bits for small triangles.
fn tile_lists_excludes(a: vec2i, b: vec2i, pixels: vec4i, is_large: bool) -> bool {
    if is_large { return edge_excludes(a, b, pixels); }
    let d = b - a;
    let innermost = grid_sample(select(pixels.xy, pixels.zw, vec2<bool>((d.y < 0), (d.x > 0))));
    return fixed_small_area(a, b, innermost) < fixed_bias(d);
}

// Adds a triangle, clockwise on screen, to the lists of the tiles that hold some of its candidate pixels and that no edge
// excludes. The tiles are divided among `invocations` invocations.
fn tile_lists_add_triangle(
    entry: u32, a: vec2i, b: vec2i, c: vec2i, pixels: vec4i, is_large: bool, invocation_index: u32, invocations: u32
) {
    let first = pixels.xy / 16;
    let tiles = pixels.zw / 16 - first + 1;
    for (var i = i32(invocation_index); i < tiles.x * tiles.y; i += i32(invocations)) {
        let tile = first + vec2i(i % tiles.x, i / tiles.x);
        let box = vec4i(max(tile * 16, pixels.xy), min(tile * 16 + 15, pixels.zw));
        let is_excluded = tile_lists_excludes(a, b, box, is_large) || tile_lists_excludes(b, c, box, is_large)
            || tile_lists_excludes(c, a, box, is_large);
        if SHAPE == SHAPE_BOXES || !is_excluded { tile_lists_add(u32(tile.y) * tiles_width() + u32(tile.x), entry); }
    }
}
