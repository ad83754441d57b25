// Tile triangles, points: the corners of triangles as discs.
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/shape
//@ use lib/tile_box
//@ use variants/depth

const TILE_BATCH = 64u;

struct TileTriangle {
    a: vec4u,
    b: vec4u,
    c: vec4u,
}

// The whole tile: discs of one triangle may lie far apart.
fn tile_triangle_box(t: Triangle, first: vec2i) -> u32 {
    return tile_box(vec4i(first, first + 15), first);
}

fn tile_triangle(t: Triangle, first: vec2i) -> TileTriangle {
    return TileTriangle(t.a, t.b, t.c);
}

// The key of the nearest corner whose disc covers the pixel.
fn tile_triangle_key(triangle: TileTriangle, at: vec2i, offset: vec2i) -> u32 {
    let corner = disc_corner(triangle.a, triangle.b, triangle.c, grid_sample(at));
    let z = select(select(triangle.c.z, triangle.b.z, corner == 1u), triangle.a.z, corner == 0u);
    return select(depth_key(bitcast<f32>(z)), 0u, corner == 3u);
}
