// raster_tiles: one workgroup per tile of 16x16 pixels, one invocation per pixel. Each invocation walks the tile's list and keeps
// the nearest key and id in registers, so no pixel needs an atomic. The invocations set up a batch of the list together, one
// triangle each.
//@ use lib/frame
//@ use lib/tiles
//@ use lib/queued_triangle
//@ use variants/tile_triangle
//@ use steps/sample_test
//@ use steps/mark_tiles

// Every covered sample must be tested, even one that could not win.
override TESTS_EVERY_SAMPLE: bool = false;
// Most entries of a list that one dispatch walks, where a driver aborts long loops; the next dispatch continues.
override MAX_LIST_ENTRIES: u32 = 0xffffffffu;

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<vec2u>;
@group(0) @binding(6) var<storage, read_write> bins: array<u32>;

var<workgroup> list: vec2u;                        // begin and end
var<workgroup> entries: array<u32, TILE_BATCH>;
var<workgroup> ids: array<u32, TILE_BATCH>;
var<workgroup> boxes: array<u32, TILE_BATCH>;      // boxes of candidate pixels, packed
var<workgroup> triangles: array<TileTriangle, TILE_BATCH>;

@compute @workgroup_size(16, 16)
fn raster_tiles(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_id) local: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let tile = workgroup.y * tiles_width() + workgroup.x;
    if invocation_index == 0u {
        // Filling the lists moved every begin to its end, which is where the next list begins.
        let begin = select(bins[max(tile, 1u) - 1u], 0u, tile == 0u);
        list = min(vec2u(begin, bins[tile]), vec2u(frame.bin_capacity));
        // Earlier dispatches came this far. The clamp keeps every index inside the list.
        list.x = min(list.x + bins[tiles_count() + tile], list.y);
        list.y = list.x + min(list.y - list.x, MAX_LIST_ENTRIES);
        bins[tiles_count() + tile] += list.y - list.x;
    }
    let range = workgroupUniformLoad(&list);
    let first = vec2i(workgroup.xy * 16u);
    let at = workgroup.xy * 16u + local.xy;
    let pixel = at.y * frame.size.x + at.x;
    let is_inside = all(at < frame.size);
    var nearest = vec2u(0u); // complemented id, key
    if MAX_LIST_ENTRIES != 0xffffffffu && range.x < range.y && is_inside { nearest = depth_and_id[pixel]; }
    for (var begin = range.x; begin < range.y; begin += TILE_BATCH) {
        let count = min(range.y - begin, TILE_BATCH);
        if invocation_index < count {
            let entry = bins[tiles_lists() + begin + invocation_index];
            let t = queued_triangle(entry);
            entries[invocation_index] = entry;
            ids[invocation_index] = t.id;
            boxes[invocation_index] = tile_triangle_box(t, first);
            triangles[invocation_index] = tile_triangle(t, first);
        }
        workgroupBarrier();
        for (var i = 0u; i < count; i += 1u) {
            let box = (vec4u(boxes[i]) >> vec4u(0u, 4u, 8u, 12u)) & vec4u(15u);
            if is_inside && all(local.xy >= box.xy) && all(local.xy <= box.zw) {
                let sample = vec2u(~ids[i], tile_triangle_key(triangles[i], vec2i(at), vec2i(local.xy)));
                let is_nearer = sample.y > nearest.y || (sample.y == nearest.y && sample.x > nearest.x);
                if sample.y != 0u && (is_nearer || TESTS_EVERY_SAMPLE) {
                    if sample_test(queued_triangle(entries[i]), at, pixel) && is_nearer { nearest = sample; }
                }
            }
        }
        workgroupBarrier();
    }
    if range.x < range.y && is_inside {
        depth_and_id[pixel] = nearest;
        if all(local.xy % 8u == vec2u(0u)) { mark_tiles(vec4i(vec4u(at, at))); }
    }
}
