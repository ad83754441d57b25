// Walk, samples: draws a small triangle on the spot.
//@ use slot/coverage
//@ use common/gate
//@ use slot/visibility
//@ use slot/marks

// One flat loop over the box, so that neighbouring invocations stay together whatever their boxes' shapes.
fn walk(t: Triangle, area: i32, pixels: vec4i) {
    marks_box(pixels);
    visibility_begin(t.id);
    let is_turned = area < 0;
    let coverage = coverage_begin(t.a, select(t.b, t.c, is_turned), select(t.c, t.b, is_turned), abs(area), pixels.xy);
    let width = pixels.z - pixels.x + 1;
    let count = width * (pixels.w - pixels.y + 1);
    var row = coverage.row;
    var edges = row;
    var pixel = u32(pixels.y) * frame.size.x + u32(pixels.x);
    var x = 0;
    var y = pixels.y;
    for (var i = 0; i < count; i += 1) {
        if coverage_contains(coverage, edges) && is_drawn(t, vec2u(vec2i(pixels.x + x, y)), pixel) {
            visibility_write(pixel, coverage_key(coverage, edges), t.id);
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
