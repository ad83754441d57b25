// raster_points: the corners of every triangle that is shown, and points, as discs. Several invocations divide the rows of a triangle's discs among
// them. A triangle that would have to be clipped shows no discs.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/shape
//@ use variants/depth
//@ use variants/points
//@ use variants/framebuffer_write
//@ use steps/sample_test
//@ use steps/mark_tiles

// This is the first of several passes over the triangles: it counts.
override IS_FIRST_VISIT: bool = true;

@compute @workgroup_size(GROUP_SIZE)
fn raster_points(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let invocation = frame_invocation(workgroup, workgroups, invocation_index, GROUP_SIZE);
    // Neighbors have the same part, so that whole workgroups end here where a disc has fewer rows than there are parts.
    let part = invocation / frame.triangle_count;
    if part >= min(INVOCATIONS_PER_TRIANGLE, disc_rows()) { return; }
    let t = triangle_load(invocation % frame.triangle_count);
    let any_flag = (t.a.x | t.b.x | t.c.x) & 255u;
    if any_flag != 0u {
        if IS_FIRST_VISIT && part == 0u { triangle_rejected(any_flag); }
        return;
    }
    let orientation = triangle_orientation(t);
    if orientation == 0 {
        if IS_FIRST_VISIT && part == 0u { atomicAdd(&counters.degenerate, 1u); }
        return;
    }
    if !triangle_is_shown(draws[t.draw].flags, orientation > 0) { return; }
    if !framebuffer_begin(t.id) { return; }
    var corners = array(t.a, t.b, t.c);
    for (var i = 0u; i < 3u; i += 1u) { draw_disc(t, corners[i], i, part); }
    framebuffer_end(t.id);
}

// Draws the samples of one disc that belong to its corner, in the rows of this part.
fn draw_disc(t: Triangle, corner: vec4u, index: u32, part: u32) {
    let pixels = disc_pixels(corner);
    if any(pixels.zw < pixels.xy) { return; }
    mark_tiles(pixels);
    for (var y = pixels.y + i32(part); y <= pixels.w; y += i32(INVOCATIONS_PER_TRIANGLE)) {
        for (var x = pixels.x; x <= pixels.z; x += 1) {
            let pixel = u32(y) * frame.size.x + u32(x);
            if disc_corner(t.a, t.b, t.c, grid_sample(vec2i(x, y))) == index && sample_test(t, vec2u(vec2i(x, y)), pixel) {
                framebuffer_write(pixel, depth_key(bitcast<f32>(corner.z)), t.id);
            }
        }
    }
}
