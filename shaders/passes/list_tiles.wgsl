// List tiles: gathers the marked 8x8 tiles, so that the resolve is dispatched over those alone; the others become
// background here.
//@ use common/picture
//@ use common/counters
//@ use common/color

@group(0) @binding(13) var<storage, read> marks: array<u32>;

@compute @workgroup_size(64)
fn list_tiles(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let tile = frame_invocation(group, groups, lane, 64u);
    let tiles = (frame.size + 7u) / 8u;
    if tile >= tiles.x * tiles.y { return; }
    if marks[tile] != 0u {
        color[picture_first_listed() + atomicAdd(&counters.marked_tiles, 1u)] = tile;
        return;
    }
    let background = color_pack(frame.background);
    let first = vec2u(tile % tiles.x, tile / tiles.x) * 8u;
    let last = min(first + 8u, frame.size);
    for (var y = first.y; y < last.y; y += 1u) {
        for (var x = first.x; x < last.x; x += 1u) { color[y * frame.stride + x] = background; }
    }
}
