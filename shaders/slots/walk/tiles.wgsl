// Walk, tiles: the tiles that a small triangle may touch.
//@ use common/bins

fn walk(t: Triangle, area: i32, pixels: vec4i) {
    let b = vertex_at(select(t.b, t.c, area < 0));
    let c = vertex_at(select(t.c, t.b, area < 0));
    bins_gather(t.id, vertex_at(t.a), b, c, pixels, false, 0u, 1u);
}
