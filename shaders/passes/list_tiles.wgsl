// List tiles: gathers the marked 8x8 tiles, so that the resolve is dispatched over those alone.
//@ use common/picture
//@ use common/counters

@group(0) @binding(13) var<storage, read> tile_mask: array<u32>;

@compute @workgroup_size(64)
fn list_tiles(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let tile = frame_invocation(group, groups, lane, 64u);
    let tiles = (frame.size + 7u) / 8u;
    if tile >= tiles.x * tiles.y { return; }
    if tile_mask[tile] != 0u { color[picture_first_listed() + atomicAdd(&counters.marked_tiles, 1u)] = tile; }
}
