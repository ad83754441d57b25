// Small triangles: what raster_small does with a triangle of few candidate pixels.
// Chosen by the raster phase: tiles where triangles are put on the lists of tiles. Default: the function below, which draws
// the samples at once.
//@ use lib/frame
//@ use lib/triangle
//@ use variants/coverage
//@ use variants/framebuffer_write
//@ use steps/sample_test
//@ use steps/mark_tiles

// `area` is twice the signed area; `pixels` is the first and the last candidate pixel.
//@ declare fn small_triangle(t: Triangle, area: i32, pixels: vec4i)
fn small_triangle(t: Triangle, area: i32, pixels: vec4i) {
    mark_tiles(pixels);
    framebuffer_begin(t.id);
    let is_reversed = area < 0;
    let coverage = coverage_begin(t.a, select(t.b, t.c, is_reversed), select(t.c, t.b, is_reversed), abs(area), pixels.xy);
    let width = pixels.z - pixels.x + 1;
    let count = width * (pixels.w - pixels.y + 1);
    var row = coverage.row;
    var edges = row;
    var pixel = u32(pixels.y) * frame.size.x + u32(pixels.x);
    var x = 0;
    var y = pixels.y;
    // One flat loop over the box, so that neighboring invocations stay together for boxes of all shapes.
    for (var i = 0; i < count; i += 1) {
        if coverage_contains(coverage, edges) && sample_test(t, vec2u(vec2i(pixels.x + x, y)), pixel) {
            framebuffer_write(pixel, coverage_key(coverage, edges), t.id);
        }
        x += 1;
        edges += coverage.step_x;
        pixel += 1u;
        if x == width {
            x = 0;
            y += 1;
            row += coverage.step_y;
            edges = row;
            pixel += frame.size.x - u32(width);
        }
    }
}
