// raster_cloud: a workgroup projects the points of a block and draws the pixel of each, or its disc if that is small, and else puts it into
// the queue of medium triangles. A block whose box lies outside the picture is not read. Chosen where no pass writes the records of
// points.
//@ use lib/fixed
//@ use lib/frame
//@ use lib/triangle
//@ use lib/queues
//@ use lib/extent
//@ use glue/draws
//@ use variants/corner_records
//@ use variants/depth
//@ use variants/draw_records
//@ use variants/points
//@ use variants/loads
//@ use variants/framebuffer_write
//@ use steps/sample_test
//@ use steps/mark_tiles

// Most candidate samples, and most pixels per side, of a disc that one invocation walks.
override MAX_SMALL_SAMPLES: i32 = 128;
override MAX_SMALL_SIDE: i32 = 64;
// This is the first of several passes over the points: it fills the queue and counts.
override IS_FIRST_VISIT: bool = true;
// Flags of a point for which it is counted as dropped.
override DROPPED_FLAGS: u32 = 0u;
// No effect moves points out of the box of their block, and positions are as the file stores them.
override HAS_BLOCK_BOXES: bool = false;
// No disc is larger than the least one.
override ONLY_PIXELS: bool = false;
// Points in a block.
override POINT_BLOCK: u32 = 1024u;

// Largest distance from a point to a pixel that shows it, with something for rounding, pixels.
const POINT_REACH_PX = 35.0;

// Less than the radius of the least disc, however a product of floats is rounded.
const SURELY_LEAST_PX = 0.7;

@compute @workgroup_size(GROUP_SIZE)
fn raster_cloud(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let block = workgroup.y * workgroups.x + workgroup.x;
    let draw = draw_of_block(block);
    let first = (block - draws[draw].first_block) * POINT_BLOCK;
    let end = min(draw_point_count(draw), first + POINT_BLOCK);
    if HAS_BLOCK_BOXES {
        let e = extent_of(draw, block_box(block));
        let margin = 2.0 * POINT_REACH_PX / vec2f(frame.size) * max(e.high.w, 0.0);
        if 0.0 > e.near || any(e.sides < -margin.xxyy) { return; }
    }
    for (var i = first + invocation_index; i < end; i += GROUP_SIZE) { draw_point_at(draw, i); }
}

// Points of a draw.
fn draw_point_count(draw: u32) -> u32 {
    let next = draw + 1u;
    if next >= frame.draw_count { return frame.triangle_count - draws[draw].first_triangle; }
    return draws[next].first_triangle - draws[draw].first_triangle;
}

fn block_box(block: u32) -> Box {
    let word = frame.first_box + 6u * block;
    let low = bitcast<vec3f>(load_words3(word));
    let high = bitcast<vec3f>(load_words3(word + 3u));
    return Box(0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low);
}

// Draws the point at a position of a draw's list.
fn draw_point_at(draw: u32, position: u32) {
    let id = draws[draw].first_triangle + position;
    let record = point_record(draw, id);
    let flags = record.x & 255u;
    if flags != 0u {
        leave_out(flags);
        return;
    }
    // Most points of a large cloud stand for the pixel in which they lie.
    if ONLY_PIXELS || draw_point_radius(draw) * bitcast<f32>(record.w) < SURELY_LEAST_PX {
        draw_pixel(draw, id, record);
    } else {
        draw_disc(draw, id, record);
    }
}

// Counts a point that is not drawn, with these flags.
fn leave_out(flags: u32) {
    if IS_FIRST_VISIT && !triangle_rejected(flags) && (flags & DROPPED_FLAGS) != 0u { atomicAdd(&counters.dropped, 1u); }
}

// Draws the pixel in which a point lies.
fn draw_pixel(draw: u32, id: u32, record: vec4u) {
    let at = vertex_at(record) >> vec2u(SUBPIXEL_BITS);
    if any(bitcast<vec2u>(at) >= frame.size) { return; }
    mark_tiles(vec4i(at, at));
    if !framebuffer_begin(id) { return; }
    let pixel = u32(at.y) * frame.size.x + u32(at.x);
    let t = point_triangle(point_from(draw, record), Triangle(record, record, record, id, draw, id, 7u));
    if sample_test(t, vec2u(at), pixel) { framebuffer_write(pixel, depth_key(bitcast<f32>(record.z)), id); }
    framebuffer_end(id);
}

// Draws the disc of a point, or puts it into the queue.
fn draw_disc(draw: u32, id: u32, record: vec4u) {
    let point = point_from(draw, record);
    if point.flags != 0u {
        leave_out(point.flags);
        return;
    }
    let pixels = triangle_pixels(point.at - point.reach, point.at + point.reach);
    if any(pixels.zw < pixels.xy) { return; }
    let sides = pixels.zw - pixels.xy + 1;
    if sides.x * sides.y > MAX_SMALL_SAMPLES || max(sides.x, sides.y) > MAX_SMALL_SIDE {
        if IS_FIRST_VISIT { queues_push_medium(id); }
        return;
    }
    mark_tiles(pixels);
    if !framebuffer_begin(id) { return; }
    let t = point_triangle(point, Triangle(record, record, record, id, draw, id, 7u));
    let key = depth_key(bitcast<f32>(record.z));
    for (var y = pixels.y; y <= pixels.w; y += 1) {
        for (var x = pixels.x; x <= pixels.z; x += 1) {
            let pixel = u32(y) * frame.size.x + u32(x);
            if point_shows(point, vec2i(x, y)) && sample_test(t, vec2u(vec2i(x, y)), pixel) { framebuffer_write(pixel, key, id); }
        }
    }
    framebuffer_end(id);
}
