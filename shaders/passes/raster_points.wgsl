// Raster points: the corners of every triangle that is shown, as discs. One invocation per triangle; one that would have
// to be clipped shows none.
//@ use common/triangle
//@ use common/fixed
//@ use common/points
//@ use slot/depth
//@ use common/reject
//@ use common/gate
//@ use slot/visibility
//@ use slot/marks

// The first of several passes over the triangles counts.
override IS_FIRST: bool = true;

@compute @workgroup_size(LIST_GROUP)
fn raster_points(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let id = frame_invocation(group, groups, lane, LIST_GROUP);
    if id >= frame.triangle_count { return; }
    let t = triangle_load(id);
    let any_flag = (t.a.x | t.b.x | t.c.x) & 255u;
    if any_flag != 0u {
        if IS_FIRST { reject_count(any_flag); }
        return;
    }
    let facing = fixed_sign(fixed_edge(vertex_at(t.a), vertex_at(t.b), vertex_at(t.c)));
    if facing == 0 {
        if IS_FIRST { atomicAdd(&counters.degenerate, 1u); }
        return;
    }
    if !triangle_is_shown(draws[t.draw].flags, facing > 0) { return; }
    points_draw(t, t.a, 0u);
    points_draw(t, t.b, 1u);
    points_draw(t, t.c, 2u);
}

// The samples of one disc that belong to its corner.
fn points_draw(t: Triangle, corner: vec4u, place: u32) {
    let at = vertex_at(corner);
    let r = i32(frame.point_radius);
    let first = max(grid_first(at - r), vec2i(0));
    let last = min(grid_last(at + r + 1), vec2i(frame.size) - 1);
    if any(last < first) { return; }
    marks_box(vec4i(first, last));
    for (var y = first.y; y <= last.y; y += 1) {
        for (var x = first.x; x <= last.x; x += 1) {
            let pixel = u32(y) * frame.size.x + u32(x);
            if points_corner(t.a, t.b, t.c, grid_sample(vec2i(x, y))) == place && is_drawn(t, vec2u(vec2i(x, y)), pixel) {
                visibility_write(pixel, depth_key(bitcast<f32>(corner.z)), t.id);
            }
        }
    }
}
