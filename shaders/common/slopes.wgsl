// Slopes: how fast the weights of a triangle's corners change from pixel to pixel.

struct Slopes {
    right: vec3f, // a pixel to the right
    down: vec3f,
}

// Weights are shares of a sum, and shares are linear on the screen: the slope of a quotient. Boxes and discs have none.
fn slopes_of(t: Triangle, at: vec3u, place: Place, screen: vec2f) -> Slopes {
    if SHAPE != SHAPE_TRIANGLES { return Slopes(vec3f(0.0), vec3f(0.0)); }
    if HAS_CLIPPING && ((t.a.x | t.b.x | t.c.x) & VERTEX_CLIPPED) != 0u { return slopes_clipped(t, at, place.weights, screen); }
    let a = vertex_at(t.a);
    let b = vertex_at(t.b);
    let c = vertex_at(t.c);
    let inv_w = select(bitcast<vec3f>(vec3u(t.a.w, t.b.w, t.c.w)), vec3f(1.0), IS_AFFINE);
    let unit = f32(grid_unit());
    let right = vec3f(vec3i(b.y - c.y, c.y - a.y, a.y - b.y)) * unit * inv_w;
    let down = vec3f(vec3i(c.x - b.x, a.x - c.x, b.x - a.x)) * unit * inv_w;
    return slopes_shared(right, down, place.weights, dot(place.shares, inv_w) * fixed_weight(a, b, c));
}

// The same on the plane of a triangle that was cut, at a place of the picture from 0 to 1.
fn slopes_clipped(t: Triangle, at: vec3u, weights: vec3f, screen: vec2f) -> Slopes {
    // A loop, since compilers copy what the effects do to a corner to wherever it is called.
    var corners: array<vec4f, 3>;
    for (var i = 0u; i < 3u; i += 1u) { corners[i] = transform_vertex(t.draw, at[i], t.id); }
    let a = corners[0];
    let b = corners[1];
    let c = corners[2];
    let lines = transpose(mat3x3f(cross(b.xyw, c.xyw), cross(c.xyw, a.xyw), cross(a.xyw, b.xyw)));
    let shares = lines * vec3f(screen.x * 2.0 - 1.0, 1.0 - screen.y * 2.0, 1.0);
    let sum = dot(shares, vec3f(1.0));
    return slopes_shared(lines[0] * (2.0 / f32(frame.size.x)), lines[1] * (-2.0 / f32(frame.size.y)), weights, sum);
}

fn slopes_shared(right: vec3f, down: vec3f, weights: vec3f, sum: f32) -> Slopes {
    return Slopes((right - weights * dot(right, vec3f(1.0))) / sum, (down - weights * dot(down, vec3f(1.0))) / sum);
}
