// Integer barycentrics: doubled areas of the three parts into which a sample divides its triangle, each below 2^31. Corners
// come in the order of the file, so that every pass measures the same areas.
//@ use lib/triangle
//@ use lib/fixed

// Area opposite each corner of t.
fn areas_at(t: Triangle, at: vec2u) -> vec3u {
    let a = vertex_at(t.a);
    let b = vertex_at(t.b);
    let c = vertex_at(t.c);
    let p = grid_sample(vec2i(at));
    let extent = max(max(a, b), c) - min(min(a, b), c);
    if max(extent.x, extent.y) <= SMALL_EXTENT {
        let orientation = sign(fixed_small_area(a, b, c));
        let signed = vec3i(fixed_small_area(b, c, p), fixed_small_area(c, a, p), fixed_small_area(a, b, p)) * orientation;
        return vec3u(max(signed, vec3i(0)));
    }
    let area = fixed_edge(a, b, c);
    let shift = fixed_shift(fixed_abs(area));
    let orientation = fixed_sign(area);
    return vec3u(
        areas_shifted(fixed_edge(b, c, p), orientation, shift),
        areas_shifted(fixed_edge(c, a, p), orientation, shift),
        areas_shifted(fixed_edge(a, b, p), orientation, shift));
}

fn areas_shifted(edge: Wide, orientation: i32, shift: u32) -> u32 {
    return select(0u, fixed_down(fixed_abs(edge), shift), fixed_sign(edge) == orientation);
}
