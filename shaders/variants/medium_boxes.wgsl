// Medium boxes: how the workgroups of raster_medium draw the boxes of queued triangles.
// Chosen by how work is shared, as for large_tiles.
//
// `group` of `groups` workgroups.
//@ declare fn medium_boxes(group: u32, groups: u32, invocation_index: u32)

//@ variant default
// A workgroup for every triangle.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/queues
//@ use lib/queued_triangle
//@ use variants/coverage
//@ use variants/framebuffer_write
//@ use steps/sample_test
//@ use steps/mark_tiles

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

//@ variant shared
// Workgroups take triangles in turn; where triangles are few, several workgroups share one. In a large box each
// invocation first examines one block of 8x8 pixels, so that only blocks are visited that the triangle touches and in which it shows.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/queues
//@ use lib/queued_triangle
//@ use lib/hidden_blocks
//@ use variants/coverage
//@ use variants/framebuffer_write
//@ use steps/sample_test
//@ use steps/mark_tiles

// Most workgroups that share a triangle.
const MAX_BOX_PARTS = 4u;
// Blocks in a box from which on examining them pays.
const MIN_EXAMINED = 16u;

// First and last slot of the queue.
var<workgroup> box_slots: vec2u;
// Blocks of the triangle's box.
var<workgroup> blocks: u32;
// Of up to 64 blocks those that are drawn: how many, and for each the distance from the first, in blocks, across and down.
var<workgroup> listed: atomic<u32>;
var<workgroup> list: array<u32, 64>;

fn medium_boxes(group: u32, groups: u32, invocation_index: u32) {
    if invocation_index == 0u { box_slots = vec2u(queues_medium_done(), queues_medium_count()); }
    let range = workgroupUniformLoad(&box_slots);
    let count = range.y - range.x;
    let parts = clamp(groups / max(count, 1u), 1u, MAX_BOX_PARTS);
    for (var item = group; item < count * parts; item += groups) {
        draw_triangle(range.x + item / parts, item % parts, parts, invocation_index);
    }
}

// Draws a part of a triangle.
fn draw_triangle(slot: u32, part: u32, parts: u32, invocation_index: u32) {
    let word = frame.medium_first + slot;
    let entry = queues[word];
    let t = queued_triangle(entry);
    let low = min(min(vertex_at(t.a), vertex_at(t.b)), vertex_at(t.c));
    let high = max(max(vertex_at(t.a), vertex_at(t.b)), vertex_at(t.c));
    let pixels = triangle_pixels(low, high);
    let sides = pixels.zw / 8 - pixels.xy / 8 + 1;
    let is_drawn = framebuffer_begin(t.id) && !(SKIPS_HIDDEN_ENTRIES && (entry & HIDDEN_ENTRY) != 0u);
    if invocation_index == 0u {
        blocks = select(0u, u32(sides.x * sides.y), is_drawn);
        if part == 0u { mark_tiles(pixels); }
    }
    let count = workgroupUniformLoad(&blocks);
    if count == 0u { return; }
    let mine = vec2i(vec2u(invocation_index % 8u, invocation_index / 8u));
    if !HIDES_BLOCKS || count < MIN_EXAMINED {
        draw_box(t, pixels, mine, i32(part), i32(parts));
        framebuffer_end(t.id);
        return;
    }

    // Blocks are aligned, so a part of the first ones may lie outside the box.
    let first = (pixels.xy / 8) * 8;
    let coverage = coverage_of(t, first);
    var shown = 0u;
    for (var begin = 0u; begin * parts < count; begin += 64u) {
        // Every invocation has read the list before.
        workgroupBarrier();
        if invocation_index == 0u { atomicStore(&listed, 0u); }
        workgroupBarrier();
        let number = (begin + invocation_index) * parts + part;
        let place = vec2i(vec2u(number % u32(sides.x), number / u32(sides.x)));
        if number < count && box_block_is_drawn(coverage, first, place * 8) {
            list[atomicAdd(&listed, 1u)] = u32(place.x) | (u32(place.y) << 16u);
        }
        workgroupBarrier();
        let drawn = min(atomicLoad(&listed), 64u);
        shown += drawn;
        for (var i = 0u; i < drawn; i += 1u) {
            let offset = vec2i(vec2u(list[i] & 0xffffu, list[i] >> 16u)) * 8 + mine;
            let at = first + offset;
            let edges = coverage_at(coverage, offset);
            let is_covered = coverage_contains(coverage, edges) && all(at >= pixels.xy) && all(at <= pixels.zw);
            if is_covered && sample_test(t, vec2u(at), u32(at.y) * frame.size.x + u32(at.x)) {
                framebuffer_write(u32(at.y) * frame.size.x + u32(at.x), coverage_key(coverage, edges), t.id);
            }
        }
    }
    framebuffer_end(t.id);
    // One workgroup has seen the whole triangle.
    if MARKS_ENTRIES && parts == 1u && shown == 0u && invocation_index == 0u { queues[word] = entry | HIDDEN_ENTRY; }
}

// Visits every `parts`th row of blocks of a box.
fn draw_box(t: Triangle, pixels: vec4i, mine: vec2i, part: i32, parts: i32) {
    let first = pixels.xy + mine + vec2i(0, 8 * part);
    let coverage = coverage_of(t, first);
    var row = coverage.row;
    for (var y = first.y; y <= pixels.w; y += 8 * parts) {
        var edges = row;
        for (var x = first.x; x <= pixels.z; x += 8) {
            if coverage_contains(coverage, edges) && sample_test(t, vec2u(vec2i(x, y)), u32(y) * frame.size.x + u32(x)) {
                framebuffer_write(u32(y) * frame.size.x + u32(x), coverage_key(coverage, edges), t.id);
            }
            edges += coverage.step_x * 8;
        }
        for (var i = 0; i < parts; i += 1) { row += coverage.step_y * 8; }
    }
}

fn coverage_of(t: Triangle, first: vec2i) -> Coverage {
    let area = fixed_small_area(vertex_at(t.a), vertex_at(t.b), vertex_at(t.c));
    let is_reversed = area < 0;
    return coverage_begin(t.a, select(t.b, t.c, is_reversed), select(t.c, t.b, is_reversed), abs(area), first);
}

// Does the triangle touch the block that begins so many pixels from the first, and may it show there?
fn box_block_is_drawn(coverage: Coverage, first: vec2i, from_first: vec2i) -> bool {
    let edges = coverage_at(coverage, from_first);
    if !coverage_touches(coverage, edges) { return false; }
    return !hidden_block_test(first + from_first, coverage_range(coverage), coverage_fills(coverage, edges));
}
