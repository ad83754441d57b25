// depth_reduce: the farthest depth key of every 8x8 and of every 64x64 pixels, the latter per workgroup. A pixel without a
// triangle is the farthest of all; pixels outside the picture do not count.
//@ use lib/frame
//@ use lib/meshlets
//@ use variants/framebuffer_read

@group(0) @binding(28) var<storage, read_write> hiz: array<u32>;

var<workgroup> tiles: array<u32, 64>;

@compute @workgroup_size(64)
fn depth_reduce(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) invocation_index: u32) {
    let tile = workgroup.xy * 8u + vec2u(invocation_index % 8u, invocation_index / 8u);
    var key = 0xffffffffu;
    for (var i = 0u; i < 64u; i += 1u) {
        let at = tile * 8u + vec2u(i % 8u, i / 8u);
        if all(at < frame.size) { key = min(key, framebuffer_load(at.y * frame.size.x + at.x).y); }
    }
    hiz[tile.y * culling.hiz_width + tile.x] = key;
    tiles[invocation_index] = key;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if invocation_index < half { tiles[invocation_index] = min(tiles[invocation_index], tiles[invocation_index + half]); }
        workgroupBarrier();
    }
    if invocation_index == 0u { hiz[culling.hiz_first_block + workgroup.y * (culling.hiz_width / 8u) + workgroup.x] = tiles[0]; }
}
