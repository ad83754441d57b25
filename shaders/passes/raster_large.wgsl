// Raster large: one workgroup per 64x64 tile of a large triangle, in sixteen blocks of 16x16 pixels.
//@ use slot/pieces
//@ use slot/queues
//@ use common/rounds
//@ use common/fixed
//@ use common/reach
//@ use slot/blocks
//@ use slot/block_keys
//@ use slot/depth
//@ use common/gate
//@ use slot/visibility

// Three edges of sixteen blocks.
var<workgroup> blocks: array<BlockEdge, 48>;

@compute @workgroup_size(64)
fn raster_large(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let slot = rounds_tiles_done() + group.y * groups.x + group.x;
    let count = min(atomicLoad(&counters.tiles), frame.tile_capacity);
    let is_live = slot < count;
    let place = frame.tile_first + 2u * select(0u, slot, is_live);
    let packed = queues[place + 1u];
    let t = pieces_load(queues[place]);
    let a = vertex_at(t.a);
    var b = vertex_at(t.b);
    var c = vertex_at(t.c);
    var z = vec3u(t.a.z, t.b.z, t.c.z);
    var area = fixed_edge(a, b, c);
    if fixed_sign(area) < 0 {
        let swap = b;
        b = c;
        c = swap;
        z = z.xzy;
        area = fixed_edge(a, b, c);
    }
    let dx = vec3i(c.x - b.x, a.x - c.x, b.x - a.x);
    let dy = vec3i(c.y - b.y, a.y - c.y, b.y - a.y);
    let bias = vec3i(fixed_bias(vec2i(dx.x, dy.x)), fixed_bias(vec2i(dx.y, dy.y)), fixed_bias(vec2i(dx.z, dy.z)));

    let tile = vec2i(vec2u(packed & 0xffffu, packed >> 16u)) * 64;
    if lane < 48u {
        let block = i32(lane / 3u);
        let p = grid_sample(tile + vec2i(block % 4, block / 4) * 16);
        let edge = lane % 3u;
        let begin = select(select(a, c, edge == 1u), b, edge == 0u);
        let end = select(select(b, a, edge == 1u), c, edge == 0u);
        blocks[lane] = blocks_edge(begin, end, p, bias[edge]);
        block_keys_edge(lane, begin, end, p);
    }
    workgroupBarrier();
    if !is_live { return; }

    visibility_begin(t.id);
    let pixels = triangle_pixels(min(min(a, b), c), max(max(a, b), c));
    let keys = keys_begin_wide(z, area);
    let nearest = depth_key(bitcast<f32>(max(max(z.x, z.y), z.z)));
    let mine = vec2i(vec2u(lane % 16u, lane / 16u));
    for (var block = 0; block < 16; block += 1) {
        let origin = tile + vec2i(block % 4, block / 4) * 16;
        let e0 = blocks[block * 3];
        let e1 = blocks[block * 3 + 1];
        let e2 = blocks[block * 3 + 2];
        // An edge is largest 15 pixels along its own inward direction.
        if SHAPE != SHAPE_BOXES && !blocks_contain(e0, e1, e2, 15 * (max(dx, vec3i(0)) + max(-dy, vec3i(0)))) { continue; }
        for (var i = 0; i < 4; i += 1) {
            let offset = mine + vec2i(0, 4 * i);
            let at = origin + offset;
            let step = dx * offset.y - dy * offset.x;
            let is_inside = (SHAPE == SHAPE_BOXES || blocks_contain(e0, e1, e2, step)) && all(at >= pixels.xy) && all(at <= pixels.zw);
            if is_inside && is_drawn(t, vec2u(at), u32(at.y) * frame.size.x + u32(at.x)) {
                var key = nearest;
                if SHAPE != SHAPE_BOXES { key = block_keys_of(keys, u32(block) * 3u, e0, e1, e2, step, bias); }
                visibility_write(u32(at.y) * frame.size.x + u32(at.x), key, t.id);
            }
        }
    }
}
