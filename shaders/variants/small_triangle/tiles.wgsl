// Small triangles, tiles: the triangle is added to the lists of the tiles that it may touch.
//@ use lib/triangle
//@ use lib/tile_lists

fn small_triangle(t: Triangle, area: i32, pixels: vec4i) {
    let b = vertex_at(select(t.b, t.c, area < 0));
    let c = vertex_at(select(t.c, t.b, area < 0));
    tile_lists_add_triangle(t.id, vertex_at(t.a), b, c, pixels, false, 0u, 1u);
}
