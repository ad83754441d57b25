// Projection: from stored vertices to snapped vertices, and cuts at the planes of the clipper.
// Chosen by the accuracy axis `vertex_transform`: strict for that option, float for all others. Default: float.
//
// A clip-space position.
//@ declare struct ClipPosition
// The snapped vertex of a vertex, or of a corner of the triangle `id` where triangles share no vertices.
//@ declare fn projection_record(draw: u32, vertex: u32, id: u32) -> vec4u
// A corner that was not rejected, before clipping.
//@ declare fn projection_corner(draw: u32, vertex: u32, id: u32) -> ClipPosition
// Does a position lie outside a plane, given as VERTEX_NEAR, VERTEX_LEFT and so on?
//@ declare fn projection_is_outside(plane: u32, v: ClipPosition) -> bool
// Where the edge from its inside to its outside end meets a plane.
//@ declare fn projection_cut(plane: u32, inside: ClipPosition, outside: ClipPosition) -> ClipPosition
// The snapped vertex of a corner that was cut at `planes`.
//@ declare fn projection_cut_record(clip: ClipPosition, planes: u32) -> vec4u

//@ variant float
// Clip space and the snap in f32.
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
    // On a plane w follows from another coordinate, and the one that changes less along the edge is more exact.
    if abs(projection_plane_w(plane, along)) < abs(along.w) { clip.w = projection_plane_w(plane, clip); }
    return clip;
}

// The w of a position on a plane, from the other coordinate that the plane fixes.
fn projection_plane_w(plane: u32, v: ClipPosition) -> f32 {
    let guard = f32(SNAP_GUARD_BAND);
    let center = frame.center;
    switch plane {
        case VERTEX_NEAR: { return v.z; }
        case VERTEX_LEFT: { return -v.x * center.x / (guard + center.x); }
        case VERTEX_RIGHT: { return v.x * center.x / (guard - center.x); }
        case VERTEX_TOP: { return v.y * center.y / (guard + center.y); }
        default: { return -v.y * center.y / (guard - center.y); }
    }
}

fn projection_cut_record(clip: ClipPosition, planes: u32) -> vec4u {
    let inv_w = 1.0 / max(clip.w, 1e-30);
    let at = snap_clipped(snap_position(clip, inv_w, frame.center), planes);
    let depth = select(clamp(clip.z * inv_w, 0.0, 1.0), 1.0, (planes & VERTEX_NEAR) != 0u);
    return snap_pack(at, bitcast<u32>(depth), bitcast<u32>(inv_w), 0u);
}

//@ variant strict
// Clip space and the snap in softfloat, every operation in a fixed order, so that records are the same on
// every adapter and on the CPU. There are no vertex effects here.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/attributes
//@ use lib/geometry
//@ use lib/softfloat
//@ use lib/snap
//@ use variants/draw_records

// Bits of x, y, z, w.
alias ClipPosition = vec4u;

// No visible w is smaller: 2^-20 m, the least distance of a near plane.
const PROJECTION_LEAST_W = 0x35800000u;

// ((m0 x + m1 y) + m2 z) + m3
fn projection_row(m: vec4f, p: vec3u) -> u32 {
    let row = bitcast<vec4u>(m);
    let sum = softfloat_add(softfloat_multiply(row.x, p.x), softfloat_multiply(row.y, p.y));
    return softfloat_add(softfloat_add(sum, softfloat_multiply(row.z, p.z)), row.w);
}

fn projection_clip(draw: u32, position: vec3u) -> ClipPosition {
    var p = position;
    if IS_RELATIVE {
        let origin = bitcast<vec3u>(draw_origin(draw));
        p = vec3u(softfloat_subtract(p.x, origin.x), softfloat_subtract(p.y, origin.y), softfloat_subtract(p.z, origin.z));
    }
    let rows = transpose(draws[draw].clip_from_object);
    var z = bitcast<u32>(rows[2].w);
    if !IS_PERSPECTIVE { z = projection_row(rows[2], p); }
    return vec4u(projection_row(rows[0], p), projection_row(rows[1], p), z, projection_row(rows[3], p));
}

fn projection_snap(clip: ClipPosition, inv_w: u32) -> vec2i {
    let center = bitcast<vec2u>(frame.center);
    let x = softfloat_round(softfloat_multiply(softfloat_multiply(clip.x, inv_w), center.x));
    let y = softfloat_round(softfloat_multiply(softfloat_multiply(clip.y, inv_w), center.y));
    return vec2i(frame.center) + vec2i(x, -y);
}

fn projection_record(draw: u32, vertex: u32, id: u32) -> vec4u {
    let bits = position_bits(draw, vertex);
    let class_of_bits = bit_class(bits);
    let clip = projection_clip(draw, select(bits, vec3u(0u), vec3<bool>(class_of_bits != 0u)));
    let w = softfloat_order(clip.w);
    let is_behind_near = softfloat_order(clip.z) <= w && w > 0;
    let inv_w = softfloat_divide(SOFTFLOAT_ONE, select(SOFTFLOAT_ONE, clip.w, is_behind_near));
    return snap_record(class_of_bits, is_behind_near, projection_snap(clip, inv_w), softfloat_multiply(clip.z, inv_w), inv_w);
}

fn projection_corner(draw: u32, vertex: u32, id: u32) -> ClipPosition {
    return projection_clip(draw, position_bits(draw, vertex));
}

// Signed distance to a plane, positive inside: w - z, or (guard +- center) w +- center x.
fn projection_distance(plane: u32, v: ClipPosition) -> u32 {
    if plane == VERTEX_NEAR { return softfloat_subtract(v.w, v.z); }
    let is_x = plane == VERTEX_LEFT || plane == VERTEX_RIGHT;
    let center = select(frame.center.y, frame.center.x, is_x);
    let reach = SNAP_GUARD_BAND + select(-i32(center), i32(center), plane == VERTEX_LEFT || plane == VERTEX_TOP);
    let beside = softfloat_multiply(select(v.y, v.x, is_x), bitcast<u32>(center));
    let is_added = plane == VERTEX_LEFT || plane == VERTEX_BOTTOM;
    return softfloat_add(softfloat_multiply(softfloat_from(reach), v.w), select(softfloat_negate(beside), beside, is_added));
}

fn projection_is_outside(plane: u32, v: ClipPosition) -> bool {
    return softfloat_order(projection_distance(plane, v)) < 0;
}

fn projection_clamp(v: u32) -> u32 {
    let order = softfloat_order(v);
    return select(select(v, SOFTFLOAT_ONE, order > i32(SOFTFLOAT_ONE)), 0u, order <= 0);
}

// inside + (outside - inside) t
fn projection_mix(inside: u32, along: u32, t: u32) -> u32 {
    return softfloat_add(inside, softfloat_multiply(along, t));
}

fn projection_cut(plane: u32, inside: ClipPosition, outside: ClipPosition) -> ClipPosition {
    let near = projection_distance(plane, inside);
    let apart = softfloat_subtract(near, projection_distance(plane, outside));
    var t = 0u;
    if softfloat_order(apart) > 0 { t = projection_clamp(softfloat_divide(near, apart)); }
    var along: vec4u;
    var clip: vec4u;
    for (var i = 0; i < 4; i += 1) {
        along[i] = softfloat_subtract(outside[i], inside[i]);
        clip[i] = projection_mix(inside[i], along[i], t);
    }
    // On the near plane w equals z, and the one that changes less along the edge is more exact.
    if plane == VERTEX_NEAR && (along.z & ~SOFTFLOAT_SIGN) < (along.w & ~SOFTFLOAT_SIGN) { clip.w = clip.z; }
    return clip;
}

fn projection_cut_record(clip: ClipPosition, planes: u32) -> vec4u {
    let is_small = softfloat_order(clip.w) < i32(PROJECTION_LEAST_W);
    let inv_w = softfloat_divide(SOFTFLOAT_ONE, select(clip.w, PROJECTION_LEAST_W, is_small));
    let depth = projection_clamp(softfloat_multiply(clip.z, inv_w));
    let is_on_near = (planes & VERTEX_NEAR) != 0u;
    return snap_pack(snap_clipped(projection_snap(clip, inv_w), planes), select(depth, SOFTFLOAT_ONE, is_on_near), inv_w, 0u);
}
