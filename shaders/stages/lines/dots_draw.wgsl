// dots_draw: one invocation per dot. A pixel shows its strongest dot: a maximum, which does not depend on the order of dots, so
// a dot that fades in front never hides one behind it.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/dots
//@ use effects/dots
//@ use variants/dot_list
//@ use variants/framebuffer_read
//@ use variants/depth

// The picture; behind its last row, the strength of the dots on every pixel.
@group(0) @binding(11) var<storage, read_write> color: array<atomic<u32>>;

// Does a dot at this depth lie on the surface of the pixel, or in front of it?
fn dot_is_visible(depth: u32, pixel: u32) -> bool {
    let key = framebuffer_load(pixel).y;
    return key == 0u || depth + dot_frame.bias >= depth_bits(key);
}

@compute @workgroup_size(64)
fn dots_draw(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let id = frame_invocation(workgroup, workgroups, invocation_index, 64u);
    if id >= dot_list_count() { return; }
    let entry = dot_list_at(id);
    let record = dots_record(dots_clip(entry.x, entry.y));
    if (record.x & 255u) != 0u { return; }
    let number = dot_runs[entry.x].first + entry.y;
    let strength = dots_strength(number, dots_halved(record.w, dot_frame.fade_from, dot_frame.levels), dot_frame.fade_rate);
    if strength == 0u { return; }
    let at = vertex_at(record);
    let radius = i32(dot_frame.radius) + 128;
    // First and last pixel whose sample the dot may touch.
    let first = max((at - radius + 127) >> vec2u(8u), vec2i(0));
    let last = min((at + radius - 128) >> vec2u(8u), vec2i(frame.size) - 1);
    for (var y = first.y; y <= last.y; y += 1) {
        for (var x = first.x; x <= last.x; x += 1) {
            let coverage = dots_cover(vec2i(x, y) * 256 + 128 - at, dot_frame.radius);
            let pixel = u32(y) * frame.size.x + u32(x);
            let visibility = select(dot_frame.hidden, DOTS_FULL, dot_is_visible(record.z, pixel));
            let shown = (((strength * coverage) >> 8u) * visibility) >> 8u;
            if shown > 0u { atomicMax(&color[color_end() + pixel], shown); }
        }
    }
}
