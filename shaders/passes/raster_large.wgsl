// Raster large: one workgroup per 64x64 tile of a large triangle. Edge functions of 49 bits are rebased once per block of
// 16x16 pixels to an i32 that keeps every sign: all pixels of a block share their sub-pixel phase, so E = 256 w + r.
//@ use slot/pieces
//@ use slot/queues
//@ use common/fixed
//@ use common/reach
//@ use common/gate
//@ use slot/visibility

const LARGE_SATURATED = 1073741824; // 2^30

struct Rebased {
    q: i32,     // floor(E / 256) at the block's first pixel, saturated to +-2^30
    r: u32,     // E mod 256
    e: f32,     // E
}

// Three edges of sixteen blocks.
var<workgroup> rebased: array<Rebased, 48>;

// E / 256 without its remainder, where it may be saturated without changing the sign of any pixel of the block.
fn rebase(e: Wide, bias: i32) -> Rebased {
    let biased = fixed_sub(e, Wide(0u, u32(bias)));
    let high = bitcast<i32>(biased.hi) >> 8u;
    let low = bitcast<i32>((biased.lo >> 8u) | (biased.hi << 24u));
    let fits = (high == 0 && low >= 0 && low <= LARGE_SATURATED) || (high == -1 && low < 0 && low >= -LARGE_SATURATED);
    let saturated = select(LARGE_SATURATED, -LARGE_SATURATED, bitcast<i32>(biased.hi) < 0);
    return Rebased(select(saturated, low, fits), biased.lo & 255u, fixed_to_f32(e));
}

// Weight of an edge at a covered sample, `step` from its block's first pixel: E as a float, within two roundings.
fn weight(edge: Rebased, step: i32, bias: i32) -> f32 {
    let exact = 256.0 * f32(edge.q + step) + f32(edge.r + u32(bias));
    return select(exact, edge.e + 256.0 * f32(step), edge.q == LARGE_SATURATED);
}

@compute @workgroup_size(64)
fn raster_large(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let slot = group.y * groups.x + group.x;
    let count = min(atomicLoad(&counters.tiles), frame.tile_capacity);
    let is_live = slot < count;
    let place = frame.tile_first + 2u * select(0u, slot, is_live);
    let packed = queues[place + 1u];
    let t = pieces_load(queues[place]);
    let a = vertex_at(t.a);
    var b = vertex_at(t.b);
    var c = vertex_at(t.c);
    var z = bitcast<vec3f>(vec3u(t.a.z, t.b.z, t.c.z));
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
        let p = (tile + vec2i(block % 4, block / 4) * 16) * 256 + 128;
        let edge = lane % 3u;
        let begin = select(select(a, c, edge == 1u), b, edge == 0u);
        let end = select(select(b, a, edge == 1u), c, edge == 0u);
        rebased[lane] = rebase(fixed_edge(begin, end, p), bias[edge]);
    }
    workgroupBarrier();
    if !is_live { return; }

    let pixels = triangle_pixels(min(min(a, b), c), max(max(a, b), c));
    let depth = z * (1.0 / fixed_to_f32(area));
    let range = vec2f(min(min(z.x, z.y), z.z), max(max(z.x, z.y), z.z));
    let mine = vec2i(vec2u(lane % 16u, lane / 16u));
    for (var block = 0; block < 16; block += 1) {
        let origin = tile + vec2i(block % 4, block / 4) * 16;
        let e0 = rebased[block * 3];
        let e1 = rebased[block * 3 + 1];
        let e2 = rebased[block * 3 + 2];
        let q = vec3i(e0.q, e1.q, e2.q);
        // An edge is largest 15 pixels along its own inward direction.
        if SHAPE != SHAPE_BOXES && any(q + 15 * (max(dx, vec3i(0)) + max(-dy, vec3i(0))) < vec3i(0)) { continue; }
        for (var i = 0; i < 4; i += 1) {
            let offset = mine + vec2i(0, 4 * i);
            let at = origin + offset;
            let step = dx * offset.y - dy * offset.x;
            let w = q + step;
            let is_inside = (SHAPE == SHAPE_BOXES || (w.x | w.y | w.z) >= 0) && all(at >= pixels.xy) && all(at <= pixels.zw);
            if is_inside && is_drawn(t, vec2u(at), u32(at.y) * frame.size.x + u32(at.x)) {
                let value = weight(e0, step.x, bias.x) * depth.x + weight(e1, step.y, bias.y) * depth.y + weight(e2, step.z, bias.z) * depth.z;
                let key = max(bitcast<u32>(select(clamp(value, range.x, range.y), range.y, SHAPE == SHAPE_BOXES)), 1u);
                visibility_write(u32(at.y) * frame.size.x + u32(at.x), key, t.id);
            }
        }
    }
}
