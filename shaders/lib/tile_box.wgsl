// Boxes of candidate pixels within a tile of 16x16 pixels, packed: first and last, four bits each, x before y.
//@ use lib/triangle

fn tile_box(pixels: vec4i, first: vec2i) -> u32 {
    let box = vec4u(clamp(pixels - first.xyxy, vec4i(0), vec4i(15)));
    return box.x | (box.y << 4u) | (box.z << 8u) | (box.w << 12u);
}

// The box of a triangle, in the tile that begins at pixel `first`.
fn tile_box_of(t: Triangle, first: vec2i) -> u32 {
    let a = vertex_at(t.a);
    let b = vertex_at(t.b);
    let c = vertex_at(t.c);
    return tile_box(triangle_pixels(min(min(a, b), c), max(max(a, b), c)), first);
}
