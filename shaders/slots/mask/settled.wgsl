// Mask, settled: where the corners of a triangle, or of a piece, lie in the image whose alpha says what is drawn, in 1/256 of
// a texel. Rounded here and nowhere else, so that no two passes can differ about it. Of whole triangles the words are the
// scene's own; only what clipping left is placed in floats.
//@ use common/texels
//@ use common/transform

// Two records: x and y of three corners, and behind them 1 + the word of the material's record; 0 for one without a mask.
fn mask_settle(t: Triangle, at: vec3u) {
    let record = texels_record(t.draw);
    let paint = texels_paint(record);
    if (paint.flags & PAINT_MASKED) == 0u {
        decisions_store(t.entry, SAMPLE_SETUPS - 1u, vec4u(0u));
        return;
    }
    let a = mask_corner(paint.first_corner + 2u * at.x);
    let b = mask_corner(paint.first_corner + 2u * at.y);
    let c = mask_corner(paint.first_corner + 2u * at.z);
    var corners = array<vec2i, 3>(a, b, c);
    if IS_CLIPPED_TRIANGLES {
        // A loop, since compilers copy what the effects do to a corner to wherever it is called.
        var v: array<vec3f, 3>;
        for (var i = 0u; i < 3u; i += 1u) { v[i] = transform_vertex(t.draw, at[i], t.id).xyw; }
        // Homogeneous shares of the parent's corners (Olano and Greer 1997).
        let lines = mat3x3f(cross(v[1], v[2]), cross(v[2], v[0]), cross(v[0], v[1]));
        corners[0] = a + mask_between(lines, vertex_at(t.a), b - a, c - a);
        corners[1] = a + mask_between(lines, vertex_at(t.b), b - a, c - a);
        corners[2] = a + mask_between(lines, vertex_at(t.c), b - a, c - a);
    }
    let words = array<vec2u, 3>(bitcast<vec2u>(corners[0]), bitcast<vec2u>(corners[1]), bitcast<vec2u>(corners[2]));
    decisions_store(t.entry, SAMPLE_SETUPS - 2u, vec4u(words[0], words[1]));
    decisions_store(t.entry, SAMPLE_SETUPS - 1u, vec4u(words[2], record + 1u, 0u));
}

fn mask_corner(place: u32) -> vec2i {
    return bitcast<vec2i>(vec2u(texels_word(place), texels_word(place + 1u)));
}

// Way from the first corner's place to that of a snapped position on the parent's plane.
fn mask_between(lines: mat3x3f, position: vec2i, ab: vec2i, ac: vec2i) -> vec2i {
    let ndc = (vec2f(position) - frame.center) / frame.center;
    let shares = vec3f(ndc.x, -ndc.y, 1.0) * lines;
    let sum = shares.x + shares.y + shares.z;
    let way = (vec2f(ab) * shares.y + vec2f(ac) * shares.z) / select(1.0, sum, sum != 0.0);
    return vec2i(round(clamp(way, vec2f(-1073741824.0), vec2f(1073741824.0))));
}
