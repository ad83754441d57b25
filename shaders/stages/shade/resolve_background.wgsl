// resolve_background: visits every pixel of the tiles of 8x8 that no triangle touches, where dots or image effects finish the background, and writes
// gamma-encoded bytes. The resolve pass would execute both sides of its branch there on a CPU adapter, and shade nothing.
//@ use lib/frame
//@ use lib/color
//@ use lib/picture
//@ use steps/finish_step

@compute @workgroup_size(8, 8)
fn resolve_background(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u, @builtin(local_invocation_id) local: vec3u
) {
    // These tiles stand at the end of the list, the first one last.
    let tiles = (frame.size + 7u) / 8u;
    let last = tiles.x * tiles.y - 1u;
    let entry = workgroup.y * workgroups.x + workgroup.x;
    let tile = color[tile_list() + last - min(entry, last)];
    let at = vec2u(tile % tiles.x, tile / tiles.x) * 8u + local.xy;
    let pixel = min(at, frame.size - 1u);
    background = background_of_row(pixel.y);
    let finished = color_pack(finish_step(background, pixel));
    // A number of workgroups that is folded to two dimensions may exceed that of tiles.
    if entry < atomicLoad(&counters.background_tiles) && all(at < frame.size) {
        color[pixel.y * frame.stride + pixel.x] = finished;
    }
}
