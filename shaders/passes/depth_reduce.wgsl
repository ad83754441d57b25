// DepthReduce: the farthest depth key of every 8x8 pixels and of every 64x64, which one workgroup looks at. A pixel without an
// triangle id is farthest of all; beyond the picture there is nothing.
//@ use common/frame
//@ use common/culling
//@ use slot/owner

@group(0) @binding(28) var<storage, read_write> hiz: array<u32>;

var<workgroup> tiles: array<u32, 64>;

@compute @workgroup_size(64)
fn depth_reduce(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let tile = group.xy * 8u + vec2u(lane % 8u, lane / 8u);
    var key = 0xffffffffu;
    for (var i = 0u; i < 64u; i += 1u) {
        let at = tile * 8u + vec2u(i % 8u, i / 8u);
        if all(at < frame.size) { key = min(key, owner_load(at.y * frame.size.x + at.x).y); }
    }
    hiz[tile.y * culling.hiz_width + tile.x] = key;
    tiles[lane] = key;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if lane < half { tiles[lane] = min(tiles[lane], tiles[lane + half]); }
        workgroupBarrier();
    }
    if lane == 0u { hiz[culling.hiz_first_block + group.y * (culling.hiz_width / 8u) + group.x] = tiles[0]; }
}
