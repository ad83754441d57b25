// Clip-space corners of a triangle after the vertex effects, for triangles that were clipped and so have no snapped corners.
//@ use variants/vertex_effects

struct ClipCorners {
    a: vec4f,
    b: vec4f,
    c: vec4f,
}

// Corners of the triangle `id`; `at`: its vertices within its draw. A loop, because compilers inline the vertex effects wherever
// they are called. It fills no array: NVIDIA's driver 580.159 loses members of array elements that a loop writes.
fn clip_corners(draw: u32, at: vec3u, id: u32) -> ClipCorners {
    var a: vec4f;
    var b: vec4f;
    var c: vec4f;
    for (var i = 0u; i < 3u; i += 1u) {
        let vertex = select(select(at.z, at.y, i == 1u), at.x, i == 0u);
        let corner = vertex_effects_clip_of(draw, vertex, id);
        if i == 0u { a = corner; } else if i == 1u { b = corner; } else { c = corner; }
    }
    return ClipCorners(a, b, c);
}
