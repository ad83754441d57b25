// Trs: doubled areas opposite the corners at a sample, as whole numbers below 2^31. Corners come in the order of the file,
// so that every kernel measures the same parts.
//@ use common/triangle
//@ use common/fixed

fn parts_of(t: Triangle, at: vec2u) -> vec3u {
    let a = vertex_at(t.a);
    let b = vertex_at(t.b);
    let c = vertex_at(t.c);
    let p = grid_sample(vec2i(at));
    let sides = max(max(a, b), c) - min(min(a, b), c);
    if max(sides.x, sides.y) <= 32768 {
        let turn = sign(fixed_small_area(a, b, c));
        let signed = vec3i(fixed_small_area(b, c, p), fixed_small_area(c, a, p), fixed_small_area(a, b, p)) * turn;
        return vec3u(max(signed, vec3i(0)));
    }
    let area = fixed_edge(a, b, c);
    let shift = fixed_shift(fixed_abs(area));
    let turn = fixed_sign(area);
    return vec3u(
        parts_shifted(fixed_edge(b, c, p), turn, shift),
        parts_shifted(fixed_edge(c, a, p), turn, shift),
        parts_shifted(fixed_edge(a, b, p), turn, shift));
}

fn parts_shifted(edge: Wide, turn: i32, shift: u32) -> u32 {
    return select(0u, fixed_down(fixed_abs(edge), shift), fixed_sign(edge) == turn);
}
