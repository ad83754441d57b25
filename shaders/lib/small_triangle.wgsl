// Small triangle: an invocation fetches, culls and classifies a triangle. A small one is drawn at once; another waits in a queue for
// the pass of its size. Classifying and drawing in one pass saves a second fetch of the small triangles.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/queues
//@ use variants/points
//@ use variants/triangle_source
//@ use variants/coverage
//@ use variants/framebuffer_write
//@ use steps/sample_test
//@ use steps/mark_tiles

// Most candidate samples, and most pixels per side, of a small triangle; chosen for the adapter.
override MAX_SMALL_SAMPLES: i32 = 128;
override MAX_SMALL_SIDE: i32 = 64;
// This is the first of several passes over the triangles: it fills the queues and counts.
override IS_FIRST_VISIT: bool = true;
// A covered sample costs so much more than the test that finds it, that an invocation first lists the covered ones: those beside it in
// the workgroup then work on theirs at the same time. Boxes have at most 32 samples.
override LISTS_SAMPLES: bool = false;
// Flags of a corner for which a triangle is dropped instead of clipped.
override DROPPED_FLAGS: u32 = 0u;

fn small_triangle(invocation: u32) {
    // Loads come before the first branch, so uniform loads are done once, even on CPU drivers that turn branches into lane masks.
    let source = triangle_source(invocation);
    let id = source.x;
    let t = triangle_of(source.y, source.z);
    let draw_flags = draws[t.draw].flags;
    if id >= frame.triangle_count { return; }
    let any_flag = (t.a.x | t.b.x | t.c.x) & 255u;
    if any_flag != 0u {
        if IS_FIRST_VISIT { queue_unprojected(t, any_flag); }
        return;
    }

    let a = vertex_at(t.a);
    let b = vertex_at(t.b);
    let c = vertex_at(t.c);
    let low = min(min(a, b), c);
    let high = max(max(a, b), c);
    let is_large = max(high.x - low.x, high.y - low.y) > SMALL_EXTENT;
    var area = fixed_small_area(a, b, c);
    if is_large { area = fixed_sign(fixed_edge(a, b, c)); }
    if area == 0 {
        if IS_FIRST_VISIT { atomicAdd(&counters.degenerate, 1u); }
        return;
    }
    if !triangle_is_shown(draw_flags, area > 0) { return; }
    let box = triangle_box(t, vec4i(low, high));
    let pixels = triangle_pixels(box.xy, box.zw);
    if any(pixels.zw < pixels.xy) { return; }
    if is_large {
        if IS_FIRST_VISIT { queues_push_large(id); }
        return;
    }

    let sides = pixels.zw - pixels.xy + 1;
    if sides.x * sides.y > MAX_SMALL_SAMPLES || max(sides.x, sides.y) > MAX_SMALL_SIDE {
        if IS_FIRST_VISIT { queues_push_medium(id); }
        return;
    }
    draw_small(t, area, pixels);
}

// `area` is twice the signed area; `pixels` is the first and the last candidate pixel.
fn draw_small(t: Triangle, area: i32, pixels: vec4i) {
    mark_tiles(pixels);
    if !framebuffer_begin(t.id) { return; }
    let is_reversed = area < 0;
    let coverage = coverage_begin(t.a, select(t.b, t.c, is_reversed), select(t.c, t.b, is_reversed), abs(area), pixels.xy);
    let width = pixels.z - pixels.x + 1;
    let count = width * (pixels.w - pixels.y + 1);
    if LISTS_SAMPLES {
        draw_listed(t, coverage, pixels.xy, width, count);
        framebuffer_end(t.id);
        return;
    }
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
    framebuffer_end(t.id);
}

// Finds the covered samples among `count` in rows of `width`, and then draws them.
fn draw_listed(t: Triangle, coverage: Coverage, first: vec2i, width: i32, count: i32) {
    var covered = 0u;
    var row = coverage.row;
    var edges = row;
    var x = 0;
    for (var i = 0u; i < u32(count); i += 1u) {
        covered |= u32(coverage_contains(coverage, edges)) << i;
        x += 1;
        edges += coverage.step_x;
        if x == width {
            x = 0;
            row += coverage.step_y;
            edges = row;
        }
    }
    while covered != 0u {
        let i = i32(firstTrailingBit(covered));
        covered &= covered - 1u;
        let offset = vec2i(i % width, i / width);
        let at = vec2u(first + offset);
        let pixel = at.y * frame.size.x + at.x;
        if sample_test(t, at, pixel) {
            framebuffer_write(pixel, coverage_key(coverage, coverage_at(coverage, offset)), t.id);
        }
    }
}

// A corner was rejected, or lies between the eye and the near plane or outside the guard band.
fn queue_unprojected(t: Triangle, any_flag: u32) {
    if triangle_rejected(any_flag) { return; }
    if (any_flag & DROPPED_FLAGS) != 0u {
        atomicAdd(&counters.dropped, 1u);
        return;
    }
    if (t.a.x & t.b.x & t.c.x & VERTEX_CLIPPED) == 0u { queues_push_clip(t.id); }
}
