// Coverage, float: edge functions in f32, in pixels, stepped from sample to sample as most kernels of its kind do it. What
// rounds to the wrong side of an edge leaves a hole or is drawn twice.
//@ use common/fixed
//@ use common/grid
//@ use common/vertex
//@ use slot/depth

// Samples on an edge belong to the triangle only where the edge is a top or left one; else all do.
override IS_TOP_LEFT: bool = true;

struct Coverage {
    row: vec3f,       // edge functions at the current row's first sample, px^2
    step_x: vec3f,    // change per pixel to the right
    step_y: vec3f,    // change per pixel down
    least: vec3f,     // what a sample must reach to be inside
    depth: vec3f,     // corner depths over the doubled area
    range: vec2f,     // smallest and largest corner depth
}

// Sets up at the centre of pixel `first`. Corners must be clockwise on screen; `area` is twice their area, > 0.
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

// What is stepped, so many pixels right and down of the first.
fn coverage_at(coverage: Coverage, offset: vec2i) -> vec3f {
    return coverage.row + coverage.step_x * f32(offset.x) + coverage.step_y * f32(offset.y);
}

fn coverage_contains(coverage: Coverage, edges: vec3f) -> bool {
    return all(edges >= coverage.least);
}

// Depth key at a covered sample, at least 1.
fn coverage_key(coverage: Coverage, edges: vec3f) -> u32 {
    let z = edges.x * coverage.depth.x + edges.y * coverage.depth.y + edges.z * coverage.depth.z;
    return depth_key(clamp(z, coverage.range.x, coverage.range.y));
}
