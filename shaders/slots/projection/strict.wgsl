// Projection, strict: clip space and the snap in soft floats, every operation in a fixed order, so that records are the same
// on every adapter and on the CPU. Nothing moves vertices here.
//@ use common/frame
//@ use common/transform
//@ use common/soft

// Bits of x, y, z, w.
alias Position = vec4u;

// w is metres; then z is the same everywhere.
override IS_PERSPECTIVE: bool = true;

// No visible w is smaller: 2^-20 m, the nearest that a near plane may be.
const PROJECTION_LEAST_W = 0x35800000u;

// ((m0 x + m1 y) + m2 z) + m3
fn projection_row(m: vec4f, p: vec3u) -> u32 {
    let row = bitcast<vec4u>(m);
    let sum = soft_add(soft_multiply(row.x, p.x), soft_multiply(row.y, p.y));
    return soft_add(soft_add(sum, soft_multiply(row.z, p.z)), row.w);
}

fn projection_clip(draw: u32, place: vec3u) -> Position {
    var p = place;
    if IS_RELATIVE {
        let origin = bitcast<vec3u>(draws[draw].origin.xyz);
        p = vec3u(soft_subtract(p.x, origin.x), soft_subtract(p.y, origin.y), soft_subtract(p.z, origin.z));
    }
    let rows = transpose(draws[draw].clip_from_object);
    var z = bitcast<u32>(rows[2].w);
    if !IS_PERSPECTIVE { z = projection_row(rows[2], p); }
    return vec4u(projection_row(rows[0], p), projection_row(rows[1], p), z, projection_row(rows[3], p));
}

fn projection_snap(clip: Position, inv_w: u32) -> vec2i {
    let center = bitcast<vec2u>(frame.center);
    let x = soft_round(soft_multiply(soft_multiply(clip.x, inv_w), center.x));
    let y = soft_round(soft_multiply(soft_multiply(clip.y, inv_w), center.y));
    return vec2i(frame.center) + vec2i(x, -y);
}

// The record of a vertex.
fn projection_record(draw: u32, vertex: u32, id: u32) -> vec4u {
    let bits = transform_bits(draw, vertex);
    let gate = vertex_gate(bits);
    let clip = projection_clip(draw, select(bits, vec3u(0u), vec3<bool>(gate != 0u)));
    let w = soft_order(clip.w);
    let is_near = soft_order(clip.z) <= w && w > 0;
    let inv_w = soft_divide(SOFT_ONE, select(SOFT_ONE, clip.w, is_near));
    return vertex_record(gate, is_near, projection_snap(clip, inv_w), soft_multiply(clip.z, inv_w), inv_w);
}

// A corner that was not rejected, before clipping.
fn projection_corner(draw: u32, vertex: u32, id: u32) -> Position {
    return projection_clip(draw, transform_bits(draw, vertex));
}

// Signed distance to a plane, positive inside: w - z, or (guard +- center) w +- center x.
fn projection_distance(plane: u32, v: Position) -> u32 {
    if plane == VERTEX_NEAR { return soft_subtract(v.w, v.z); }
    let is_x = plane == VERTEX_LEFT || plane == VERTEX_RIGHT;
    let center = select(frame.center.y, frame.center.x, is_x);
    let reach = VERTEX_GUARD_BAND + select(-i32(center), i32(center), plane == VERTEX_LEFT || plane == VERTEX_TOP);
    let beside = soft_multiply(select(v.y, v.x, is_x), bitcast<u32>(center));
    let is_added = plane == VERTEX_LEFT || plane == VERTEX_BOTTOM;
    return soft_add(soft_multiply(soft_from(reach), v.w), select(soft_negate(beside), beside, is_added));
}

fn projection_is_beyond(plane: u32, v: Position) -> bool {
    return soft_order(projection_distance(plane, v)) < 0;
}

fn projection_clamp(v: u32) -> u32 {
    let order = soft_order(v);
    return select(select(v, SOFT_ONE, order > i32(SOFT_ONE)), 0u, order <= 0);
}

// inside + (outside - inside) t
fn projection_mix(inside: u32, way: u32, t: u32) -> u32 {
    return soft_add(inside, soft_multiply(way, t));
}

// Where an edge from its inside to its outside end meets a plane.
fn projection_cut(plane: u32, inside: Position, outside: Position) -> Position {
    let near = projection_distance(plane, inside);
    let apart = soft_subtract(near, projection_distance(plane, outside));
    var t = 0u;
    if soft_order(apart) > 0 { t = projection_clamp(soft_divide(near, apart)); }
    var way: vec4u;
    var clip: vec4u;
    for (var i = 0; i < 4; i += 1) {
        way[i] = soft_subtract(outside[i], inside[i]);
        clip[i] = projection_mix(inside[i], way[i], t);
    }
    // On the near plane w is z, and whichever changes less along the edge is the more exact.
    if plane == VERTEX_NEAR && (way.z & ~SOFT_SIGN) < (way.w & ~SOFT_SIGN) { clip.w = clip.z; }
    return clip;
}

// The record of a corner that was cut off by `planes`.
fn projection_cut_record(clip: Position, planes: u32) -> vec4u {
    let is_small = soft_order(clip.w) < i32(PROJECTION_LEAST_W);
    let inv_w = soft_divide(SOFT_ONE, select(clip.w, PROJECTION_LEAST_W, is_small));
    let depth = projection_clamp(soft_multiply(clip.z, inv_w));
    let is_on_near = (planes & VERTEX_NEAR) != 0u;
    return vertex_pack(vertex_held(projection_snap(clip, inv_w), planes), select(depth, SOFT_ONE, is_on_near), inv_w, 0u);
}
