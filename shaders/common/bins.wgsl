// Bins: on which tiles' lists a triangle belongs.
//@ use common/tiles
//@ use common/fixed
//@ use common/grid
//@ use common/reach
//@ use slot/bins

// Do all samples of a box of pixels lie on the outer side of an edge? The sign at the innermost of them tells.
fn bins_are_outside(a: vec2i, b: vec2i, pixels: vec4i, is_large: bool) -> bool {
    let d = b - a;
    let inner = grid_sample(select(pixels.xy, pixels.zw, vec2<bool>((d.y < 0), (d.x > 0))));
    if is_large { return fixed_sign(fixed_edge(a, b, inner)) < fixed_bias(d); }
    return fixed_small_area(a, b, inner) < fixed_bias(d);
}

// Puts a triangle, clockwise on screen, on the lists of the tiles that hold some of its candidate pixels and that no edge
// rules out. Each of several lanes takes its share of the tiles.
fn bins_gather(entry: u32, a: vec2i, b: vec2i, c: vec2i, pixels: vec4i, is_large: bool, lane: u32, lanes: u32) {
    let first = pixels.xy / 16;
    let tiles = pixels.zw / 16 - first + 1;
    for (var i = i32(lane); i < tiles.x * tiles.y; i += i32(lanes)) {
        let tile = first + vec2i(i % tiles.x, i / tiles.x);
        let box = vec4i(max(tile * 16, pixels.xy), min(tile * 16 + 15, pixels.zw));
        let is_beyond = bins_are_outside(a, b, box, is_large) || bins_are_outside(b, c, box, is_large) || bins_are_outside(c, a, box, is_large);
        if SHAPE == SHAPE_BOXES || !is_beyond { bins_add(u32(tile.y) * tiles_width() + u32(tile.x), entry); }
    }
}
