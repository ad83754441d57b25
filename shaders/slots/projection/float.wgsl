// Projection, float: clip space and the one snap in f32. The default option.
//@ use common/frame
//@ use common/transform

alias Position = vec4f;

// The record of a vertex, or of a corner of the triangle `id` where effects part them.
fn projection_record(draw: u32, vertex: u32, id: u32) -> vec4u {
    let bits = transform_bits(draw, vertex);
    let gate = vertex_gate(bits);
    let clip = movement_clip(draw, vertex, id, vertex_position(bits, gate));
    let is_near = clip.z <= clip.w && clip.w > 0.0;
    let inv_w = 1.0 / select(1.0, clip.w, is_near);
    let at = vertex_snap(clip, inv_w, frame.center);
    return vertex_record(gate, is_near, at, bitcast<u32>(clip.z * inv_w), bitcast<u32>(inv_w));
}

// A corner that was not rejected, before clipping.
fn projection_corner(draw: u32, vertex: u32, id: u32) -> Position {
    return transform_vertex(draw, vertex, id);
}

// Signed distance to a plane, positive inside; the guard planes are where X or Y is +-32,767.996 px.
fn projection_distance(plane: u32, v: Position) -> f32 {
    let guard = f32(VERTEX_GUARD_BAND);
    let center = frame.center;
    switch plane {
        case VERTEX_NEAR: { return v.w - v.z; }
        case VERTEX_LEFT: { return v.x * center.x + (guard + center.x) * v.w; }
        case VERTEX_RIGHT: { return (guard - center.x) * v.w - v.x * center.x; }
        case VERTEX_TOP: { return (guard + center.y) * v.w - v.y * center.y; }
        default: { return (guard - center.y) * v.w + v.y * center.y; }
    }
}

fn projection_is_beyond(plane: u32, v: Position) -> bool {
    return projection_distance(plane, v) < 0.0;
}

// Where an edge from its inside to its outside end meets a plane.
fn projection_cut(plane: u32, inside: Position, outside: Position) -> Position {
    let near = projection_distance(plane, inside);
    let far = projection_distance(plane, outside);
    // Two ends that rounding puts alike near a plane have no quotient.
    let t = select(0.0, clamp(near / (near - far), 0.0, 1.0), near > far);
    let way = outside - inside;
    var clip = inside + way * t;
    // On the near plane w is z, and whichever changes less along the edge is the more exact.
    if plane == VERTEX_NEAR && abs(way.z) < abs(way.w) { clip.w = clip.z; }
    return clip;
}

// The record of a corner that was cut off by `planes`.
fn projection_cut_record(clip: Position, planes: u32) -> vec4u {
    let inv_w = 1.0 / max(clip.w, 1e-30);
    let at = vertex_held(vertex_snap(clip, inv_w, frame.center), planes);
    let depth = select(clamp(clip.z * inv_w, 0.0, 1.0), 1.0, (planes & VERTEX_NEAR) != 0u);
    return vertex_pack(at, bitcast<u32>(depth), bitcast<u32>(inv_w), 0u);
}
