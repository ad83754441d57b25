// SampleSetup: settles, once per triangle or piece, the integers that sample effects and masks hold their samples against. What
// comes from floats is rounded here and nowhere else, so that no two passes can differ about it.
//@ use common/center
//@ use common/counters
//@ use common/sample
//@ use slot/pieces
//@ use slot/mask
//@ use slot/screen
//@ use glue/decide

// The pieces that clipping left, instead of the triangles.
override IS_CLIPPED_TRIANGLES: bool = false;
override SAMPLE_SETUPS: u32 = 1u;

fn decisions_store(entry: u32, place: u32, words: vec4u) {
    vertices[frame.vertex_count + entry * SAMPLE_SETUPS + place] = words;
}

@compute @workgroup_size(GROUP_SIZE)
fn decide(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = frame_invocation(group, groups, lane, GROUP_SIZE);
    var count = frame.triangle_count;
    if IS_CLIPPED_TRIANGLES { count = min(atomicLoad(&counters.pieces), frame.clipped_triangle_capacity); }
    if index >= count { return; }
    let t = pieces_load(index | select(0u, 0x80000000u, IS_CLIPPED_TRIANGLES));
    let at = triangle_vertices(t.draw, t.id - draws[t.draw].first_triangle);
    var center_screen: vec2f;
    if IS_CLIPPED_TRIANGLES {
        // A loop, since compilers copy what the effects do to a corner to wherever it is called.
        var corners: array<vec4f, 3>;
        for (var i = 0u; i < 3u; i += 1u) { corners[i] = transform_vertex(t.draw, at[i], t.id); }
        center_screen = center_clipped(corners[0], corners[1], corners[2], vec2f(0.5));
    } else {
        if ((t.a.x | t.b.x | t.c.x) & 255u) != 0u { return; }
        center_screen = center_whole(t.a, t.b, t.c);
    }
    mask_settle(t, at);
    let center = center_world(t.draw, at);
    center_screen = screen_of(center, center_screen);
    glue_decide(TriangleSetup(t.id, vertex_at(t.a), vertex_at(t.b), vertex_at(t.c), t.outline, frame.size, center, center_screen), t.entry);
}
