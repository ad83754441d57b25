// list_tiles: lists the marked tiles of 8x8 pixels, so that the resolve pass is dispatched over those alone.
//@ use lib/frame
//@ use lib/picture

@group(0) @binding(13) var<storage, read> tile_mask: array<u32>;

@compute @workgroup_size(64)
fn list_tiles(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let tile = frame_invocation(workgroup, workgroups, invocation_index, 64u);
    let tiles = (frame.size + 7u) / 8u;
    if tile >= tiles.x * tiles.y { return; }
    if tile_mask[tile] != 0u { color[color_end() + atomicAdd(&counters.marked_tiles, 1u)] = tile; }
}
