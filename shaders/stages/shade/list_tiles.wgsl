// list_tiles: lists the tiles of 8x8 pixels that triangles have marked, so that the resolve pass is dispatched over those alone, and the tiles
// that the picture before has drawn in: the resolve shows the background there again. Where dots or image effects finish the background, the other
// tiles are listed from the end on.
//@ use lib/frame
//@ use lib/picture
//@ use lib/tile_mask

@group(0) @binding(13) var<storage, read_write> tile_mask: array<u32>;

override LISTS_BACKGROUND: bool = false;

@compute @workgroup_size(64)
fn list_tiles(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let tile = frame_invocation(workgroup, workgroups, invocation_index, 64u);
    let tiles = (frame.size + 7u) / 8u;
    let count = tiles.x * tiles.y;
    if tile >= count { return; }
    let mark = tile_mask[tile];
    if mark != 0u {
        color[tile_list() + atomicAdd(&counters.marked_tiles, 1u)] = tile;
    } else if LISTS_BACKGROUND {
        color[tile_list() + count - 1u - atomicAdd(&counters.background_tiles, 1u)] = tile;
    }
    tile_mask[tile] = select(0u, TILE_DRAWN_BEFORE, mark == TILE_DRAWN);
}
