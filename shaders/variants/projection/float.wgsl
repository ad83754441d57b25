// Projection, float: clip space and the snap in f32.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/attributes
//@ use lib/snap
//@ use variants/vertex_effects

alias ClipPosition = vec4f;

fn projection_record(draw: u32, vertex: u32, id: u32) -> vec4u {
    let bits = position_bits(draw, vertex);
    let class_of_bits = bit_class(bits);
    let clip = vertex_effects_clip(draw, vertex, id, floats_of_class(bits, class_of_bits));
    let is_behind_near = clip.z <= clip.w && clip.w > 0.0;
    let inv_w = 1.0 / select(1.0, clip.w, is_behind_near);
    let at = snap_position(clip, inv_w, frame.center);
    return snap_record(class_of_bits, is_behind_near, at, bitcast<u32>(clip.z * inv_w), bitcast<u32>(inv_w));
}

fn projection_corner(draw: u32, vertex: u32, id: u32) -> ClipPosition {
    return vertex_effects_clip_of(draw, vertex, id);
}

// Signed distance to a plane, positive inside; the guard band ends where x or y is +-32,767.996 px.
fn projection_distance(plane: u32, v: ClipPosition) -> f32 {
    let guard = f32(SNAP_GUARD_BAND);
    let center = frame.center;
    switch plane {
        case VERTEX_NEAR: { return v.w - v.z; }
        case VERTEX_LEFT: { return v.x * center.x + (guard + center.x) * v.w; }
        case VERTEX_RIGHT: { return (guard - center.x) * v.w - v.x * center.x; }
        case VERTEX_TOP: { return (guard + center.y) * v.w - v.y * center.y; }
        default: { return (guard - center.y) * v.w + v.y * center.y; }
    }
}

fn projection_is_outside(plane: u32, v: ClipPosition) -> bool {
    return projection_distance(plane, v) < 0.0;
}

fn projection_cut(plane: u32, inside: ClipPosition, outside: ClipPosition) -> ClipPosition {
    let near = projection_distance(plane, inside);
    let far = projection_distance(plane, outside);
    // Two ends that rounding makes equally far from the plane have no quotient.
    let t = select(0.0, clamp(near / (near - far), 0.0, 1.0), near > far);
    let along = outside - inside;
    var clip = inside + along * t;
    // On the near plane w equals z, and the one that changes less along the edge is more exact.
    if plane == VERTEX_NEAR && abs(along.z) < abs(along.w) { clip.w = clip.z; }
    return clip;
}

fn projection_cut_record(clip: ClipPosition, planes: u32) -> vec4u {
    let inv_w = 1.0 / max(clip.w, 1e-30);
    let at = snap_clipped(snap_position(clip, inv_w, frame.center), planes);
    let depth = select(clamp(clip.z * inv_w, 0.0, 1.0), 1.0, (planes & VERTEX_NEAR) != 0u);
    return snap_pack(at, bitcast<u32>(depth), bitcast<u32>(inv_w), 0u);
}
