// Coverage, float: edge functions in f32, in pixels, stepped from sample to sample as most kernels of this kind do. Rounding to
// the wrong side of an edge leaves a hole or draws a sample twice.
//@ use lib/fixed
//@ use lib/triangle
//@ use variants/depth


struct Coverage {
    row: vec3f,       // edge functions at the current row's first sample, px^2
    step_x: vec3f,    // change per pixel to the right
    step_y: vec3f,    // change per pixel down
    least: vec3f,     // least edge functions of a covered sample
    depth: vec3f,     // corner depths over the doubled area
    range: vec2f,     // smallest and largest corner depth
}

fn coverage_begin(a: vec4u, b: vec4u, c: vec4u, area: i32, first: vec2i) -> Coverage {
    let pixels = 1.0 / f32(grid_unit());
    let pa = vec2f(vertex_at(a)) * pixels;
    let pb = vec2f(vertex_at(b)) * pixels;
    let pc = vec2f(vertex_at(c)) * pixels;
    let p = vec2f(first) + 0.5;
    let dx = vec3f(pc.x - pb.x, pa.x - pc.x, pb.x - pa.x);
    let dy = vec3f(pc.y - pb.y, pa.y - pc.y, pb.y - pa.y);
    let owns = (dy < vec3f(0.0)) | ((dy == vec3f(0.0)) & (dx > vec3f(0.0)));
    let z = bitcast<vec3f>(vec3u(a.z, b.z, c.z));
    var coverage: Coverage;
    coverage.row = dx * (p.y - vec3f(pb.y, pc.y, pa.y)) - dy * (p.x - vec3f(pb.x, pc.x, pa.x));
    coverage.step_x = -dy;
    coverage.step_y = dx;
    coverage.least = select(vec3f(0.0), vec3f(1e-30), !owns & vec3<bool>(IS_TOP_LEFT));
    coverage.depth = z / (f32(area) * pixels * pixels);
    coverage.range = vec2f(min(min(z.x, z.y), z.z), max(max(z.x, z.y), z.z));
    return coverage;
}

fn coverage_at(coverage: Coverage, offset: vec2i) -> vec3f {
    return coverage.row + coverage.step_x * f32(offset.x) + coverage.step_y * f32(offset.y);
}

fn coverage_contains(coverage: Coverage, edges: vec3f) -> bool {
    return all(edges >= coverage.least);
}

fn coverage_key(coverage: Coverage, edges: vec3f) -> u32 {
    let z = edges.x * coverage.depth.x + edges.y * coverage.depth.y + edges.z * coverage.depth.z;
    return depth_key(clamp(z, coverage.range.x, coverage.range.y));
}

// Rounding differs from sample to sample, so nothing is certain about a block.
fn coverage_touches(coverage: Coverage, edges: vec3f) -> bool {
    return true;
}

fn coverage_fills(coverage: Coverage, edges: vec3f) -> bool {
    return false;
}

fn coverage_range(coverage: Coverage) -> vec2u {
    return vec2u(depth_key(coverage.range.x), depth_key(coverage.range.y));
}
