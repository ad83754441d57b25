// Raster tiles: one workgroup per 16x16 tile of the picture, one invocation per pixel. It walks the tile's list and keeps key
// and triangle id to itself, so no pixel needs an atomic. The lanes set up a batch of the list together, each a triangle of it.
//@ use slot/pieces
//@ use common/tiles
//@ use common/gate
//@ use slot/cells
//@ use slot/marks

// Every covered sample must ask whether it is drawn, even one that could not win.
override TESTS_EVERY_SAMPLE: bool = false;
// Most entries of a list that one dispatch walks, where a driver ends long loops; the next one goes on.
override MAX_LIST_ENTRIES: u32 = 0xffffffffu;

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<vec2u>;
@group(0) @binding(6) var<storage, read_write> bins: array<u32>;

var<workgroup> list: vec2u;                         // begin and end
var<workgroup> entries: array<u32, CELLS_BATCH>;
var<workgroup> ids: array<u32, CELLS_BATCH>;
var<workgroup> reaches: array<u32, CELLS_BATCH>;    // boxes of candidate pixels, packed
var<workgroup> cells: array<Cell, CELLS_BATCH>;

@compute @workgroup_size(16, 16)
fn raster_tiles(
    @builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u, @builtin(local_invocation_index) lane: u32
) {
    let tile = group.y * tiles_width() + group.x;
    if lane == 0u {
        // Filling moved every begin to its end, which is where the next list begins.
        let begin = select(bins[max(tile, 1u) - 1u], 0u, tile == 0u);
        list = min(vec2u(begin, bins[tile]), vec2u(frame.bin_capacity));
        // Earlier dispatches came so far; no index leaves the list, whatever its end says.
        list.x = min(list.x + bins[tiles_count() + tile], list.y);
        list.y = list.x + min(list.y - list.x, MAX_LIST_ENTRIES);
        bins[tiles_count() + tile] += list.y - list.x;
    }
    let range = workgroupUniformLoad(&list);
    let first = vec2i(group.xy * 16u);
    let at = group.xy * 16u + local.xy;
    let pixel = at.y * frame.size.x + at.x;
    let is_inside = all(at < frame.size);
    var nearest = vec2u(0u); // complemented id, key
    if MAX_LIST_ENTRIES != 0xffffffffu && range.x < range.y && is_inside { nearest = depth_and_id[pixel]; }
    for (var begin = range.x; begin < range.y; begin += CELLS_BATCH) {
        let count = min(range.y - begin, CELLS_BATCH);
        if lane < count {
            let entry = bins[tiles_lists() + begin + lane];
            let t = pieces_load(entry);
            entries[lane] = entry;
            ids[lane] = t.id;
            reaches[lane] = cells_reach(t, first);
            cells[lane] = cells_begin(t, first);
        }
        workgroupBarrier();
        for (var i = 0u; i < count; i += 1u) {
            let reach = (vec4u(reaches[i]) >> vec4u(0u, 4u, 8u, 12u)) & vec4u(15u);
            if is_inside && all(local.xy >= reach.xy) && all(local.xy <= reach.zw) {
                let sample = vec2u(~ids[i], cells_key(cells[i], vec2i(at), vec2i(local.xy)));
                let is_nearer = sample.y > nearest.y || (sample.y == nearest.y && sample.x > nearest.x);
                if sample.y != 0u && (is_nearer || TESTS_EVERY_SAMPLE) {
                    if is_drawn(pieces_load(entries[i]), at, pixel) && is_nearer { nearest = sample; }
                }
            }
        }
        workgroupBarrier();
    }
    if range.x < range.y && is_inside {
        depth_and_id[pixel] = nearest;
        if all(local.xy % 8u == vec2u(0u)) { marks_box(vec4i(vec4u(at, at))); }
    }
}
