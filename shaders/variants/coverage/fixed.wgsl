// Coverage, fixed: exact edge functions with the top-left rule between snapped corners, in i32, for small and medium triangles.
//@ use lib/fixed
//@ use lib/triangle
//@ use variants/depth

struct Coverage {
    row: vec3i,       // biased edge functions at the current row's first sample
    step_x: vec3i,    // change per pixel to the right
    step_y: vec3i,    // change per pixel down
    bias: vec3i,
    depth: DepthPlane,
}

fn coverage_begin(a: vec4u, b: vec4u, c: vec4u, area: i32, first: vec2i) -> Coverage {
    let pa = vertex_at(a);
    let pb = vertex_at(b);
    let pc = vertex_at(c);
    let p = grid_sample(first);
    let dx = vec3i(pc.x - pb.x, pa.x - pc.x, pb.x - pa.x);
    let dy = vec3i(pc.y - pb.y, pa.y - pc.y, pb.y - pa.y);
    let bias = vec3i(
        fixed_bias(vec2i(dx.x, dy.x)), fixed_bias(vec2i(dx.y, dy.y)), fixed_bias(vec2i(dx.z, dy.z)));
    let from_x = vec3i(p.x - pb.x, p.x - pc.x, p.x - pa.x);
    let from_y = vec3i(p.y - pb.y, p.y - pc.y, p.y - pa.y);
    var coverage: Coverage;
    coverage.row = dx * from_y - dy * from_x - bias;
    coverage.step_x = -dy * grid_unit();
    coverage.step_y = dx * grid_unit();
    coverage.bias = bias;
    coverage.depth = depth_plane(vec3u(a.z, b.z, c.z), area);
    return coverage;
}

fn coverage_at(coverage: Coverage, offset: vec2i) -> vec3i {
    return coverage.row + coverage.step_x * offset.x + coverage.step_y * offset.y;
}

fn coverage_contains(coverage: Coverage, edges: vec3i) -> bool {
    return (edges.x | edges.y | edges.z) >= 0;
}

fn coverage_key(coverage: Coverage, edges: vec3i) -> u32 {
    return depth_at(coverage.depth, edges + coverage.bias);
}

// On a grid finer than 8 bits, edge functions wrap at those samples of a block that lie outside the triangle's box.
fn coverage_touches(coverage: Coverage, edges: vec3i) -> bool {
    if SUBPIXEL_BITS > 8u { return true; }
    return coverage_contains(coverage, edges + (max(coverage.step_x, vec3i(0)) + max(coverage.step_y, vec3i(0))) * 7);
}

fn coverage_fills(coverage: Coverage, edges: vec3i) -> bool {
    if SUBPIXEL_BITS > 8u { return false; }
    return coverage_contains(coverage, edges + (min(coverage.step_x, vec3i(0)) + min(coverage.step_y, vec3i(0))) * 7);
}

fn coverage_range(coverage: Coverage) -> vec2u {
    return depth_range(coverage.depth);
}
