// Normals: stored ones as bits, sound ones as directions, and those of planes.
//@ use common/draws
//@ use common/pull
//@ use common/vertex

override F32_NORMALS: bool = false;

// A stored normal, as bits.
fn normal_bits(draw: u32, vertex: u32) -> vec3u {
    let byte = draws[draw].normal_offset + vertex * draws[draw].normal_stride;
    if F32_NORMALS {
        let word = byte / 4u;
        return vec3u(vertex_bytes[word], vertex_bytes[word + 1u], vertex_bytes[word + 2u]);
    }
    return pull_bits3(draws[draw].normal_format, byte);
}

// A normal from its bits; w is 0 where a lane is NaN, infinite or beyond 2^40.
fn normal_gated(bits: vec3u) -> vec4f {
    let gate = vertex_gate(bits);
    return vec4f(vertex_position(bits, gate), select(0.0, 1.0, gate == 0u));
}

// Direction of `v`, whatever its length; zero where it has none.
fn normal_direction(v: vec3f) -> vec3f {
    let scale = max(max(abs(v.x), abs(v.y)), abs(v.z));
    if !(scale > 0.0) || !pull_is_finite(v) { return vec3f(0.0); }
    let scaled = v / scale;
    return scaled / length(scaled);
}

// Direction of the plane's normal; zero for a sliver whose edges are parallel to within 1e-6.
fn normal_of_plane(a: vec3f, b: vec3f, c: vec3f) -> vec3f {
    let ab = b - a;
    let ac = c - a;
    let long = max(max(abs(ab.x), abs(ab.y)), abs(ab.z));
    let wide = max(max(abs(ac.x), abs(ac.y)), abs(ac.z));
    if !(long > 0.0 && wide > 0.0) { return vec3f(0.0); }
    let normal = cross(ab / long, ac / wide);
    return select(vec3f(0.0), normal, dot(normal, normal) >= 1e-12);
}

// Interpolated normal; zero where a corner has none or the corners cancel.
fn normal_mixed(a: vec4f, b: vec4f, c: vec4f, k: vec3f) -> vec3f {
    let longest = max(max(abs(a.xyz), abs(b.xyz)), abs(c.xyz));
    let scale = max(max(longest.x, longest.y), longest.z);
    if a.w * b.w * c.w == 0.0 || scale == 0.0 { return vec3f(0.0); }
    let sum = (a.xyz * k.x + b.xyz * k.y + c.xyz * k.z) / scale;
    return select(vec3f(0.0), sum, dot(sum, sum) >= 1e-12);
}
