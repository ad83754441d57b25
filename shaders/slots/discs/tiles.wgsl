// Discs, tiles: the tiles that the corners of a triangle may touch, each once.
//@ use common/points
//@ use common/tiles
//@ use slot/bins

fn discs_draw(t: Triangle, share: u32) {
    let a = discs_tiles(t.a);
    let b = discs_tiles(t.b);
    discs_gather(t.id, a, vec4i(0, 0, -1, -1), vec4i(0, 0, -1, -1));
    discs_gather(t.id, b, a, vec4i(0, 0, -1, -1));
    discs_gather(t.id, discs_tiles(t.c), a, b);
}

// First and last tile under a disc; empty where a last precedes a first.
fn discs_tiles(corner: vec4u) -> vec4i {
    let pixels = points_pixels(corner);
    return select(pixels / 16, vec4i(0, 0, -1, -1), any(pixels.zw < pixels.xy));
}

fn discs_has(tiles: vec4i, tile: vec2i) -> bool {
    return all(tile >= tiles.xy) && all(tile <= tiles.zw);
}

// Puts the triangle on the lists of `tiles` but for those that another corner has seen to.
fn discs_gather(entry: u32, tiles: vec4i, done: vec4i, done_too: vec4i) {
    for (var y = tiles.y; y <= tiles.w; y += 1) {
        for (var x = tiles.x; x <= tiles.z; x += 1) {
            let tile = vec2i(x, y);
            if !discs_has(done, tile) && !discs_has(done_too, tile) { bins_add(u32(y) * tiles_width() + u32(x), entry); }
        }
    }
}
