// Snapping: clip-space points become snapped vertices, the one place where float positions become integers.
//@ use lib/triangle

// Largest coordinate of a snapped vertex, in units.
const SNAP_GUARD_BAND = 8388607;

// The viewport transform happens in floats, before the snap.
override FLOAT_VIEWPORT: bool = false;

// Snaps a clip-space point behind the near plane. `center` is half the picture in units, so that shifting to the viewport is
// exact in integers; the option FLOAT_VIEWPORT shifts in floats.
fn snap_position(clip: vec4f, inv_w: f32, center: vec2f) -> vec2i {
    let limit = vec2f(16777216.0);
    if FLOAT_VIEWPORT { return vec2i(clamp(round((clip.xy * inv_w * vec2f(0.5, -0.5) + 0.5) * (2.0 * center)), -limit, limit)); }
    let scaled = clamp(round(clip.xy * inv_w * center), -limit, limit);
    return vec2i(center) + vec2i(scaled) * vec2i(1, -1);
}

// Outcodes against the guard band.
fn snap_guard(at: vec2i) -> u32 {
    return select(0u, VERTEX_LEFT, at.x < -SNAP_GUARD_BAND)
        | select(0u, VERTEX_RIGHT, at.x > SNAP_GUARD_BAND)
        | select(0u, VERTEX_TOP, at.y < -SNAP_GUARD_BAND)
        | select(0u, VERTEX_BOTTOM, at.y > SNAP_GUARD_BAND);
}

// Packs a record; `depth` and `inv_w` are bits of floats. A vertex outside the guard band has no position.
fn snap_pack(at: vec2i, depth: u32, inv_w: u32, flags: u32) -> vec4u {
    let is_outside = (flags & (VERTEX_LEFT | VERTEX_RIGHT | VERTEX_TOP | VERTEX_BOTTOM)) != 0u;
    let kept = select(at, vec2i(0), is_outside);
    return vec4u((bitcast<u32>(kept.x) << 8u) | flags, bitcast<u32>(kept.y) << 8u, depth, inv_w);
}

// The record of a vertex: only flags where it is rejected (`bit_class` is not 0) or between the eye and the near plane.
fn snap_record(bit_class: u32, is_behind_near: bool, at: vec2i, depth: u32, inv_w: u32) -> vec4u {
    let flags = select(bit_class, select(VERTEX_NEAR, snap_guard(at), is_behind_near), bit_class == 0u);
    let is_known = bit_class == 0u && is_behind_near;
    return snap_pack(select(vec2i(0), at, is_known), select(0u, depth, is_known), select(0u, inv_w, is_known), flags);
}

// Position of a corner that clipping made: inside the guard band, and exactly on the planes that it was cut at.
fn snap_clipped(at: vec2i, planes: u32) -> vec2i {
    var clamped = clamp(at, vec2i(-SNAP_GUARD_BAND), vec2i(SNAP_GUARD_BAND));
    if (planes & VERTEX_LEFT) != 0u { clamped.x = -SNAP_GUARD_BAND; }
    if (planes & VERTEX_RIGHT) != 0u { clamped.x = SNAP_GUARD_BAND; }
    if (planes & VERTEX_TOP) != 0u { clamped.y = -SNAP_GUARD_BAND; }
    if (planes & VERTEX_BOTTOM) != 0u { clamped.y = SNAP_GUARD_BAND; }
    return clamped;
}
