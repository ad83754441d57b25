// Raster medium: one workgroup per triangle of at most 128 px extent; its 64 lanes are an 8x8 block that visits the box.
//@ use slot/pieces
//@ use common/fixed
//@ use slot/queues
//@ use common/rounds
//@ use slot/coverage
//@ use common/gate
//@ use slot/visibility
//@ use slot/marks

@compute @workgroup_size(64)
fn raster_medium(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let slot = rounds_medium_done() + group.y * groups.x + group.x;
    if slot >= min(atomicLoad(&counters.medium), frame.medium_capacity) { return; }
    let t = pieces_load(queues[frame.medium_first + slot]);
    let low = min(min(vertex_at(t.a), vertex_at(t.b)), vertex_at(t.c));
    let high = max(max(vertex_at(t.a), vertex_at(t.b)), vertex_at(t.c));
    let pixels = triangle_pixels(low, high);
    let area = fixed_small_area(vertex_at(t.a), vertex_at(t.b), vertex_at(t.c));
    let is_turned = area < 0;

    if lane == 0u { marks_box(pixels); }
    visibility_begin(t.id);
    let mine = vec2i(vec2u(lane % 8u, lane / 8u));
    let coverage = coverage_begin(
        t.a, select(t.b, t.c, is_turned), select(t.c, t.b, is_turned), abs(area), pixels.xy + mine);
    var row = coverage.row;
    for (var y = pixels.y + mine.y; y <= pixels.w; y += 8) {
        var edges = row;
        for (var x = pixels.x + mine.x; x <= pixels.z; x += 8) {
            if coverage_contains(coverage, edges) && is_drawn(t, vec2u(vec2i(x, y)), u32(y) * frame.size.x + u32(x)) {
                visibility_write(u32(y) * frame.size.x + u32(x), coverage_key(coverage, edges), t.id);
            }
            edges += coverage.step_x * 8;
        }
        row += coverage.step_y * 8;
    }
}
