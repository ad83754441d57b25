// Coverage: which candidate samples a small or medium triangle covers, and their depth keys.
// Chosen by the accuracy axis `coverage` and by effects that draw boxes. Default: fixed.
//
// `Coverage` has the members `row`, `step_x` and `step_y`: the edge functions at the current row's first sample, and their
// change per pixel to the right and down. Their type differs from variant to variant.
//@ declare struct Coverage
// Sets up at the sample of pixel `first`. Corners must be clockwise on screen; `area` is twice their area, above 0.
//@ declare fn coverage_begin(a: vec4u, b: vec4u, c: vec4u, area: i32, first: vec2i) -> Coverage
// The edge functions at an offset in pixels from the first: `coverage_at(coverage, offset)`.
//@ declare fn coverage_at
// Is a sample with these edge functions covered? `coverage_contains(coverage, edges)`.
//@ declare fn coverage_contains
// Depth key at a covered sample, at least 1: `coverage_key(coverage, edges)`.
//@ declare fn coverage_key
// May the block of 8x8 samples be touched, of whose first sample these are the edge functions? `coverage_touches(coverage, edges)`.
//@ declare fn coverage_touches
// Are all samples of that block certainly covered? `coverage_fills(coverage, edges)`.
//@ declare fn coverage_fills
// The farthest and the nearest depth key of any sample.
//@ declare fn coverage_range(coverage: Coverage) -> vec2u

//@ variant fixed
// Exact edge functions with the top-left rule between snapped corners, in i32, for small and medium triangles.
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

//@ variant float
// Edge functions in f32, in pixels, stepped from sample to sample as most kernels of this kind do. Rounding to
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

//@ variant boxes
// Every sample of a triangle's bounding box, at the depth of its nearest corner: a rasterizer without its
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
