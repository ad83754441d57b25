// Coverage, boxes: every sample of a triangle's bounding box, at the depth of its nearest corner: a rasterizer without its
// inside test. Left and top borders belong to the box, right and bottom ones do not.
//@ use variants/depth

struct Coverage {
    row: vec3i,
    step_x: vec3i,
    step_y: vec3i,
    key: u32,
}

fn coverage_begin(a: vec4u, b: vec4u, c: vec4u, area: i32, first: vec2i) -> Coverage {
    return Coverage(vec3i(0), vec3i(0), vec3i(0), depth_key(bitcast<f32>(max(max(a.z, b.z), c.z))));
}

fn coverage_at(coverage: Coverage, offset: vec2i) -> vec3i {
    return vec3i(0);
}

fn coverage_contains(coverage: Coverage, edges: vec3i) -> bool {
    return true;
}

fn coverage_key(coverage: Coverage, edges: vec3i) -> u32 {
    return coverage.key;
}

fn coverage_touches(coverage: Coverage, edges: vec3i) -> bool {
    return true;
}

fn coverage_fills(coverage: Coverage, edges: vec3i) -> bool {
    return false;
}

fn coverage_range(coverage: Coverage) -> vec2u {
    return vec2u(coverage.key);
}
