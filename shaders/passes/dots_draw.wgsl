// Dots draw: one invocation per dot of the list. The strongest dot of a pixel shows: a maximum, so that order is none of the
// picture's business, and a dot that fades in front never hides one behind it.
//@ use common/frame
//@ use common/dots
//@ use slot/dot_list
//@ use slot/owner
//@ use slot/depth

// The picture; behind its last row, the strength of the dots on every pixel.
@group(0) @binding(11) var<storage, read_write> color: array<atomic<u32>>;

// Does a dot at this depth lie on the surface of the pixel, or before it?
fn dots_is_seen(depth: u32, pixel: u32) -> bool {
    let key = owner_load(pixel).y;
    return key == 0u || depth + dot_frame.bias >= depth_bits(key);
}

@compute @workgroup_size(64)
fn dots_draw(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let id = frame_invocation(group, groups, lane, 64u);
    if id >= dot_list_count() { return; }
    let entry = dot_list_at(id);
    let record = dots_record(dots_clip(entry.x, entry.y));
    if (record.x & 255u) != 0u { return; }
    let number = dot_runs[entry.x].first + entry.y;
    let strength = dots_strength(number, dots_halved(record.w, dot_frame.fade_from, dot_frame.levels), dot_frame.fade_rate);
    if strength == 0u { return; }
    let at = vertex_at(record);
    let reach = i32(dot_frame.radius) + 128;
    // First and last pixel whose sample the dot may touch.
    let first = max((at - reach + 127) >> vec2u(8u), vec2i(0));
    let last = min((at + reach - 128) >> vec2u(8u), vec2i(frame.size) - 1);
    for (var y = first.y; y <= last.y; y += 1) {
        for (var x = first.x; x <= last.x; x += 1) {
            let cover = dots_cover(vec2i(x, y) * 256 + 128 - at, dot_frame.radius);
            let pixel = u32(y) * frame.size.x + u32(x);
            let share = select(dot_frame.hidden, DOTS_FULL, dots_is_seen(record.z, pixel));
            let shown = (((strength * cover) >> 8u) * share) >> 8u;
            if shown > 0u { atomicMax(&color[frame.stride * frame.size.y + pixel], shown); }
        }
    }
}
