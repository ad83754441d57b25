// sample_setup: computes, once per triangle or clipped triangle, the integers that sample tests compare samples with. Values
// from floats are rounded here and nowhere else, so all passes agree.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/geometry
//@ use lib/queued_triangle
//@ use lib/sample
//@ use lib/sample_setup_write
//@ use variants/vertex_effects
//@ use steps/setup_step
//@ use glue/sample_setup

@group(0) @binding(4) var<storage, read_write> vertices: array<vec4u>;

@compute @workgroup_size(GROUP_SIZE)
fn sample_setup(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let index = frame_invocation(workgroup, workgroups, invocation_index, GROUP_SIZE);
    var count = frame.triangle_count;
    if IS_CLIPPED_TRIANGLES { count = min(atomicLoad(&counters.clipped_triangles), frame.clipped_triangle_capacity); }
    if index >= count { return; }
    let t = queued_triangle(index | select(0u, CLIPPED_ENTRY, IS_CLIPPED_TRIANGLES));
    let at = triangle_vertices(t.draw, t.id - draws[t.draw].first_triangle);
    var center_screen: vec2f;
    if IS_CLIPPED_TRIANGLES {
        // A loop, because compilers inline the vertex effects wherever they are called.
        var corners: array<vec4f, 3>;
        for (var i = 0u; i < 3u; i += 1u) { corners[i] = vertex_effects_clip_of(t.draw, at[i], t.id); }
        center_screen = center_clipped(corners[0], corners[1], corners[2], vec2f(0.5));
    } else {
        if ((t.a.x | t.b.x | t.c.x) & 255u) != 0u { return; }
        center_screen = center_unclipped(t.a, t.b, t.c);
    }
    setup_step(t, at);
    let center = center_world(t.draw, at);
    center_screen = center_in_picture(center, center_screen);
    glue_sample_setup(TriangleSetup(t.id, vertex_at(t.a), vertex_at(t.b), vertex_at(t.c), t.outline, frame.size, center, center_screen), t.entry);
}
