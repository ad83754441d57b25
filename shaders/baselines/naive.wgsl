// Naive: the beginner's compute rasterizer, rebuilt from its description as a yardstick. One invocation a triangle over
// de-indexed corners, a loop over the bounding box, float barycentrics, three 8-bit minima; depth is the color.
// Its defects are kept; only indices are clamped, so that it cannot reach outside its buffers.

struct Naive {
    clip_from_object: mat4x4f, // one draw; the viewport is folded in where the picture is to be compared
    size: vec2u,
    corner_count: u32,
    stride: u32,
}

@group(0) @binding(0) var<uniform> naive: Naive;
@group(0) @binding(1) var<storage, read> corners: array<f32>;
@group(0) @binding(2) var<storage, read_write> channels: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read_write> color: array<u32>;

@compute @workgroup_size(256)
fn naive_clear(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let i = (group.y * groups.x + group.x) * 256u + lane;
    if i < 3u * naive.size.x * naive.size.y { atomicStore(&channels[i], 255u); }
}

fn on_screen(corner: u32) -> vec3f {
    let at = 3u * corner;
    let clip = naive.clip_from_object * vec4f(corners[at], corners[at + 1u], corners[at + 2u], 1.0);
    return vec3f(clip.xy / clip.w * vec2f(naive.size), clip.w);
}

fn barycentric(a: vec3f, b: vec3f, c: vec3f, p: vec2f) -> vec3f {
    let u = cross(vec3f(c.x - a.x, b.x - a.x, a.x - p.x), vec3f(c.y - a.y, b.y - a.y, a.y - p.y));
    if abs(u.z) < 1.0 { return vec3f(-1.0, 1.0, 1.0); }
    return vec3f(1.0 - (u.x + u.y) / u.z, u.y / u.z, u.x / u.z);
}

fn is_off_screen(v: vec3f) -> bool {
    return v.x < 0.0 || v.x > f32(naive.size.x) || v.y < 0.0 || v.y > f32(naive.size.y);
}

@compute @workgroup_size(256)
fn naive_raster(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let triangle = (group.y * groups.x + group.x) * 256u + lane;
    if 3u * triangle >= naive.corner_count { return; }
    let a = on_screen(3u * triangle);
    let b = on_screen(3u * triangle + 1u);
    let c = on_screen(3u * triangle + 2u);
    if is_off_screen(a) || is_off_screen(b) || is_off_screen(c) { return; }
    let low = vec2u(min(min(a.xy, b.xy), c.xy));
    let high = vec2u(max(max(a.xy, b.xy), c.xy));
    for (var x = low.x; x <= min(high.x, naive.size.x); x += 1u) {
        for (var y = low.y; y <= min(high.y, naive.size.y); y += 1u) {
            let weights = barycentric(a, b, c, vec2f(vec2u(x, y)));
            if any(weights < vec3f(0.0)) { continue; }
            let gray = u32(clamp(50.0 * dot(weights, vec3f(a.z, b.z, c.z)) - 400.0, 0.0, 254.0));
            let pixel = min(y * naive.size.x + x, naive.size.x * naive.size.y - 1u);
            atomicMin(&channels[3u * pixel], gray);
            atomicMin(&channels[3u * pixel + 1u], gray);
            atomicMin(&channels[3u * pixel + 2u], gray);
        }
    }
}

@compute @workgroup_size(8, 8)
fn naive_resolve(@builtin(global_invocation_id) at: vec3u) {
    if any(at.xy >= naive.size) { return; }
    let pixel = 3u * (at.y * naive.size.x + at.x);
    let red = atomicLoad(&channels[pixel]);
    let green = atomicLoad(&channels[pixel + 1u]);
    let blue = atomicLoad(&channels[pixel + 2u]);
    let is_empty = min(min(red, green), blue) == 255u;
    color[at.y * naive.stride + at.x] = red | (green << 8u) | (blue << 16u) | select(0xff000000u, 0u, is_empty);
}
