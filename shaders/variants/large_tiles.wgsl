// Large tiles: how the workgroups of raster_large draw the queued tiles.
// Chosen by how work is shared: shared where workgroups take several tiles each, or where hidden blocks are left out.
//
// `group` of `groups` workgroups.
//@ declare fn large_tiles(group: u32, groups: u32, invocation_index: u32)

//@ variant default
// A workgroup for every tile. CPU adapters take it: they compile barriers inside loops very slowly.
//@ use lib/frame
//@ use lib/shape
//@ use lib/queues
//@ use lib/queued_triangle
//@ use lib/large_tile
//@ use variants/large_edges
//@ use variants/large_depth
//@ use variants/depth
//@ use variants/framebuffer_write
//@ use steps/sample_test

fn large_tiles(group: u32, groups: u32, invocation_index: u32) {
    let slot = queues_tiles_done() + group;
    let exists = slot < queues_tiles_count();
    let word = frame.tile_first + 2u * select(0u, slot, exists);
    let packed_tile = queues[word + 1u];
    let t = queued_triangle(queues[word]);
    let large = clockwise_triangle(t);

    let tile = vec2i(vec2u(packed_tile & 0xffffu, packed_tile >> 16u)) * 64;
    large_tile_prepare(large, tile, invocation_index);
    workgroupBarrier();
    if !exists { return; }

    if !framebuffer_begin(t.id) { return; }
    let pixels = clockwise_pixels(large);
    let plane = depth_plane_wide(large.z, large.area);
    let nearest = depth_key(bitcast<f32>(max(max(large.z.x, large.z.y), large.z.z)));
    let mine = vec2i(vec2u(invocation_index % 16u, invocation_index / 16u));
    for (var block = 0; block < 16; block += 1) {
        let origin = tile + vec2i(block % 4, block / 4) * 16;
        let e0 = tile_edges[block * 3];
        let e1 = tile_edges[block * 3 + 1];
        let e2 = tile_edges[block * 3 + 2];
        // An edge function is largest 15 pixels along its own inward direction.
        if SHAPE != SHAPE_BOXES && !block_contains(e0, e1, e2, 15 * (max(large.dx, vec3i(0)) + max(-large.dy, vec3i(0)))) { continue; }
        for (var i = 0; i < 4; i += 1) {
            let offset = mine + vec2i(0, 4 * i);
            let at = origin + offset;
            let step = large.dx * offset.y - large.dy * offset.x;
            let is_covered = (SHAPE == SHAPE_BOXES || block_contains(e0, e1, e2, step)) && all(at >= pixels.xy) && all(at <= pixels.zw);
            if is_covered && sample_test(t, vec2u(at), u32(at.y) * frame.size.x + u32(at.x)) {
                var key = nearest;
                if SHAPE != SHAPE_BOXES {
                    key = block_depth_key(block_depth_prepared(plane, u32(block) * 3u), e0, e1, e2, step, large.bias);
                }
                framebuffer_write(u32(at.y) * frame.size.x + u32(at.x), key, t.id);
            }
        }
    }
    framebuffer_end(t.id);
}

//@ variant shared
// Workgroups take tiles in turn; where tiles are few, several workgroups share one. First each of the 64 invocations
// examines one block of 8x8 pixels; the blocks that show are then drawn one after another, an invocation to a pixel.
//@ use lib/frame
//@ use lib/shape
//@ use lib/queues
//@ use lib/queued_triangle
//@ use lib/large_tile
//@ use lib/hidden_blocks
//@ use variants/large_edges
//@ use variants/large_depth
//@ use variants/depth
//@ use variants/framebuffer_write
//@ use steps/sample_test

// Most workgroups that share a tile.
const MAX_TILE_PARTS = 4u;

// First and last slot of the queue.
var<workgroup> tile_slots: vec2u;
// A bit for every block of 8x8 pixels that is drawn.
var<workgroup> drawn: array<atomic<u32>, 2>;
// The queue's entry of the tile.
var<workgroup> tile_entry: u32;

fn large_tiles(group: u32, groups: u32, invocation_index: u32) {
    if invocation_index == 0u { tile_slots = vec2u(queues_tiles_done(), queues_tiles_count()); }
    let range = workgroupUniformLoad(&tile_slots);
    let count = range.y - range.x;
    let parts = clamp(groups / max(count, 1u), 1u, MAX_TILE_PARTS);
    for (var item = group; item < count * parts; item += groups) {
        draw_tile(range.x + item / parts, item % parts, parts, invocation_index);
    }
}

// Draws every block of a tile whose row is of this part.
fn draw_tile(slot: u32, part: u32, parts: u32, invocation_index: u32) {
    let word = frame.tile_first + 2u * slot;
    // Every invocation has read what was prepared for the tile before.
    workgroupBarrier();
    if invocation_index == 0u { tile_entry = queues[word]; }
    let entry = workgroupUniformLoad(&tile_entry);
    if SKIPS_HIDDEN_ENTRIES && (entry & HIDDEN_ENTRY) != 0u { return; }
    let packed_tile = queues[word + 1u];
    let t = queued_triangle(entry);
    let large = clockwise_triangle(t);

    let tile = vec2i(vec2u(packed_tile & 0xffffu, packed_tile >> 16u)) * 64;
    large_tile_prepare(large, tile, invocation_index);
    if invocation_index < 2u { atomicStore(&drawn[invocation_index], 0u); }
    workgroupBarrier();

    let is_drawn = framebuffer_begin(t.id);
    let pixels = clockwise_pixels(large);
    let plane = depth_plane_wide(large.z, large.area);
    let nearest = depth_key(bitcast<f32>(max(max(large.z.x, large.z.y), large.z.z)));
    let mine = vec2i(vec2u(invocation_index % 8u, invocation_index / 8u));
    if is_drawn && tile_block_is_drawn(large, plane, pixels, tile, mine * 8) && u32(mine.y) % parts == part {
        atomicOr(&drawn[invocation_index / 32u], 1u << (invocation_index % 32u));
    }
    workgroupBarrier();
    let is_hidden = (atomicLoad(&drawn[0]) | atomicLoad(&drawn[1])) == 0u;

    for (var half = 0u; half < 2u; half += 1u) {
        var left = atomicLoad(&drawn[half]);
        for (var i = 0u; i < 32u && left != 0u; i += 1u) {
            let block = i32(half * 32u + firstTrailingBit(left));
            left &= left - 1u;
            let from_tile = vec2i(block % 8, block / 8) * 8 + mine;
            let offset = from_tile & vec2i(15);
            let index = block_edges(from_tile);
            let at = tile + from_tile;
            let step = large.dx * offset.y - large.dy * offset.x;
            let is_inside = SHAPE == SHAPE_BOXES || block_contains(tile_edges[index], tile_edges[index + 1u], tile_edges[index + 2u], step);
            let is_covered = is_inside && all(at >= pixels.xy) && all(at <= pixels.zw);
            if is_covered && sample_test(t, vec2u(at), u32(at.y) * frame.size.x + u32(at.x)) {
                var key = nearest;
                if SHAPE != SHAPE_BOXES {
                    let depth = block_depth_prepared(plane, index);
                    key = block_depth_key(depth, tile_edges[index], tile_edges[index + 1u], tile_edges[index + 2u], step, large.bias);
                }
                framebuffer_write(u32(at.y) * frame.size.x + u32(at.x), key, t.id);
            }
        }
    }
    framebuffer_end(t.id);
    // One workgroup has seen the whole tile.
    if MARKS_ENTRIES && parts == 1u && is_hidden && invocation_index == 0u { queues[word] = entry | HIDDEN_ENTRY; }
}

// Index of the edges of the block of 16x16 pixels that holds a pixel, counted from the tile's first.
fn block_edges(from_tile: vec2i) -> u32 {
    return u32((from_tile.y / 16) * 4 + from_tile.x / 16) * 3u;
}

// Does the triangle touch the block of 8x8 pixels at `from_tile`, and may it show there?
fn tile_block_is_drawn(t: ClockwiseTriangle, plane: DepthPlane, pixels: vec4i, tile: vec2i, from_tile: vec2i) -> bool {
    let first = tile + from_tile;
    if any(first > pixels.zw) || any(first + 7 < pixels.xy) { return false; }
    if SHAPE == SHAPE_BOXES { return true; }
    let offset = from_tile & vec2i(15);
    let index = block_edges(from_tile);
    let e0 = tile_edges[index];
    let e1 = tile_edges[index + 1u];
    let e2 = tile_edges[index + 2u];
    let start = t.dx * offset.y - t.dy * offset.x;
    // An edge function is largest 7 pixels along its own inward direction.
    if !block_contains(e0, e1, e2, start + 7 * (max(t.dx, vec3i(0)) + max(-t.dy, vec3i(0)))) { return false; }
    if !HIDES_BLOCKS { return true; }
    // Float edges may contain samples outside the box, which are not drawn.
    let is_boxed = all(first >= pixels.xy) && all(min(first + 7, vec2i(frame.size) - 1) <= pixels.zw);
    let is_whole = is_boxed && block_contains(e0, e1, e2, start + 7 * (min(t.dx, vec3i(0)) + min(-t.dy, vec3i(0))));
    let depths = block_depth_range(block_depth_prepared(plane, index), e0, e1, e2, start, t.dx, t.dy);
    return !hidden_block_test(first, depths, is_whole);
}
