// Medium boxes: how the workgroups of raster_medium draw the boxes of queued triangles.
// Chosen by how work is shared, as for large_tiles: shared, or by default the function below, with a workgroup for every triangle.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/queues
//@ use lib/queued_triangle
//@ use variants/coverage
//@ use variants/framebuffer_write
//@ use steps/sample_test
//@ use steps/mark_tiles

// `group` of `groups` workgroups.
//@ declare fn medium_boxes(group: u32, groups: u32, invocation_index: u32)
fn medium_boxes(group: u32, groups: u32, invocation_index: u32) {
    let slot = queues_medium_done() + group;
    if slot >= queues_medium_count() { return; }
    let t = queued_triangle(queues[frame.medium_first + slot]);
    let low = min(min(vertex_at(t.a), vertex_at(t.b)), vertex_at(t.c));
    let high = max(max(vertex_at(t.a), vertex_at(t.b)), vertex_at(t.c));
    let pixels = triangle_pixels(low, high);
    let area = fixed_small_area(vertex_at(t.a), vertex_at(t.b), vertex_at(t.c));
    let is_reversed = area < 0;

    if invocation_index == 0u { mark_tiles(pixels); }
    if !framebuffer_begin(t.id) { return; }
    let mine = vec2i(vec2u(invocation_index % 8u, invocation_index / 8u));
    let coverage = coverage_begin(
        t.a, select(t.b, t.c, is_reversed), select(t.c, t.b, is_reversed), abs(area), pixels.xy + mine);
    var row = coverage.row;
    for (var y = pixels.y + mine.y; y <= pixels.w; y += 8) {
        var edges = row;
        for (var x = pixels.x + mine.x; x <= pixels.z; x += 8) {
            if coverage_contains(coverage, edges) && sample_test(t, vec2u(vec2i(x, y)), u32(y) * frame.size.x + u32(x)) {
                framebuffer_write(u32(y) * frame.size.x + u32(x), coverage_key(coverage, edges), t.id);
            }
            edges += coverage.step_x * 8;
        }
        row += coverage.step_y * 8;
    }
    framebuffer_end(t.id);
}
