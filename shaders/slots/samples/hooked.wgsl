// Samples, hooked: the sample effects of the stack say whether a covered sample is drawn.
//@ use common/triangle
//@ use common/fixed
//@ use common/sample
//@ use glue/sample

// Sample effects that decide something per triangle.
override DECISIONS: u32 = 0u;

fn decisions_load(entry: u32, place: u32) -> vec4u {
    return vertices[frame.vertex_count + entry * DECISIONS + place];
}

// Corners come in the order of the file, so that every kernel measures the same parts.
fn samples_is_drawn(t: Triangle, at: vec2u) -> bool {
    let a = vertex_at(t.a);
    let b = vertex_at(t.b);
    let c = vertex_at(t.c);
    let p = grid_sample(vec2i(at));
    let sides = max(max(a, b), c) - min(min(a, b), c);
    var parts: vec3u;
    if max(sides.x, sides.y) <= 32768 {
        let turn = sign(fixed_small_area(a, b, c));
        let signed = vec3i(fixed_small_area(b, c, p), fixed_small_area(c, a, p), fixed_small_area(a, b, p)) * turn;
        parts = vec3u(max(signed, vec3i(0)));
    } else {
        let area = fixed_edge(a, b, c);
        let shift = fixed_shift(fixed_abs(area));
        let turn = fixed_sign(area);
        parts = vec3u(
            samples_part(fixed_edge(b, c, p), turn, shift),
            samples_part(fixed_edge(c, a, p), turn, shift),
            samples_part(fixed_edge(a, b, p), turn, shift));
    }
    return glue_sample(Sample(at, t.id, parts, vec4u()), t.entry);
}

fn samples_part(edge: Wide, turn: i32, shift: u32) -> u32 {
    return select(0u, fixed_down(fixed_abs(edge), shift), fixed_sign(edge) == turn);
}
