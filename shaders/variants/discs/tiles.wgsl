// Discs, tiles: the triangle is added to the lists of the tiles that its discs may touch, once to each.
//@ use lib/triangle
//@ use lib/shape
//@ use lib/tiles
//@ use lib/tile_lists

fn discs(t: Triangle, part: u32) {
    let a = discs_tiles(t.a);
    let b = discs_tiles(t.b);
    discs_add(t.id, a, vec4i(0, 0, -1, -1), vec4i(0, 0, -1, -1));
    discs_add(t.id, b, a, vec4i(0, 0, -1, -1));
    discs_add(t.id, discs_tiles(t.c), a, b);
}

// First and last tile under a disc; empty where the last precedes the first.
fn discs_tiles(corner: vec4u) -> vec4i {
    let pixels = disc_pixels(corner);
    return select(pixels / 16, vec4i(0, 0, -1, -1), any(pixels.zw < pixels.xy));
}

fn discs_have(tiles: vec4i, tile: vec2i) -> bool {
    return all(tile >= tiles.xy) && all(tile <= tiles.zw);
}

// Adds the triangle to the lists of `tiles`, except those that an earlier corner has dealt with.
fn discs_add(entry: u32, tiles: vec4i, done: vec4i, done_too: vec4i) {
    for (var y = tiles.y; y <= tiles.w; y += 1) {
        for (var x = tiles.x; x <= tiles.z; x += 1) {
            let tile = vec2i(x, y);
            if !discs_have(done, tile) && !discs_have(done_too, tile) { tile_lists_add(u32(y) * tiles_width() + u32(x), entry); }
        }
    }
}
