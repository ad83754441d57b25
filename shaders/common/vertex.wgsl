// The projected vertex, 16 bytes: X<<8 | flags, Y<<8, bits of depth, bits of 1/w. Mirror of `frame::SnappedVertex`.

const VERTEX_NONFINITE = 1u;
const VERTEX_OUT_OF_RANGE = 2u;
const VERTEX_NEAR = 4u;
const VERTEX_LEFT = 8u;
const VERTEX_RIGHT = 16u;
const VERTEX_TOP = 32u;
const VERTEX_BOTTOM = 64u;
const VERTEX_REJECTED = 3u;
const VERTEX_CLIPPED = 124u;

const VERTEX_GUARD_BAND = 8388607;

// The viewport's shift happens in floats, before the snap.
override FLOAT_VIEWPORT: bool = false;

// Clip space from the stored position: rejected coordinates come as 0, subnormal ones are 0.
fn vertex_gate(bits: vec3u) -> u32 {
    let exponents = (bits >> vec3u(23u)) & vec3u(255u);
    let nonfinite = any(exponents == vec3u(255u));
    let beyond = any(exponents >= vec3u(167u));
    return select(select(0u, VERTEX_OUT_OF_RANGE, beyond), VERTEX_NONFINITE, nonfinite);
}

fn vertex_position(bits: vec3u, flags: u32) -> vec3f {
    let is_zero = (bits & vec3u(0x7f800000u)) == vec3u(0u);
    return select(bitcast<vec3f>(bits), vec3f(0.0), is_zero | vec3<bool>((flags & VERTEX_REJECTED) != 0u));
}

// Snaps a clip-space point in front of the near plane: the one place where floats become positions.
// `center` is half the picture in units, so the viewport shift is an exact integer; the cheaper option shifts in floats.
fn vertex_snap(clip: vec4f, inv_w: f32, center: vec2f) -> vec2i {
    let limit = vec2f(16777216.0);
    if FLOAT_VIEWPORT { return vec2i(clamp(round((clip.xy * inv_w * vec2f(0.5, -0.5) + 0.5) * (2.0 * center)), -limit, limit)); }
    let scaled = clamp(round(clip.xy * inv_w * center), -limit, limit);
    return vec2i(center) + vec2i(scaled) * vec2i(1, -1);
}

// Outcodes against the guard band.
fn vertex_guard(at: vec2i) -> u32 {
    return select(0u, VERTEX_LEFT, at.x < -VERTEX_GUARD_BAND)
        | select(0u, VERTEX_RIGHT, at.x > VERTEX_GUARD_BAND)
        | select(0u, VERTEX_TOP, at.y < -VERTEX_GUARD_BAND)
        | select(0u, VERTEX_BOTTOM, at.y > VERTEX_GUARD_BAND);
}

// Depth and 1/w as bits.
fn vertex_pack(at: vec2i, depth: u32, inv_w: u32, flags: u32) -> vec4u {
    let unready = (flags & (VERTEX_LEFT | VERTEX_RIGHT | VERTEX_TOP | VERTEX_BOTTOM)) != 0u;
    let kept = select(at, vec2i(0), unready);
    return vec4u((bitcast<u32>(kept.x) << 8u) | flags, bitcast<u32>(kept.y) << 8u, depth, inv_w);
}

// The record of a vertex: flags alone where it was rejected or is not near-inside.
fn vertex_record(gate: u32, is_near: bool, at: vec2i, depth: u32, inv_w: u32) -> vec4u {
    let flags = select(gate, select(VERTEX_NEAR, vertex_guard(at), is_near), gate == 0u);
    let is_known = gate == 0u && is_near;
    return vertex_pack(select(vec2i(0), at, is_known), select(0u, depth, is_known), select(0u, inv_w, is_known), flags);
}

// Where a corner that was cut off lies: inside the guard band, and on the planes that it was put on.
fn vertex_held(at: vec2i, planes: u32) -> vec2i {
    var held = clamp(at, vec2i(-VERTEX_GUARD_BAND), vec2i(VERTEX_GUARD_BAND));
    if (planes & VERTEX_LEFT) != 0u { held.x = -VERTEX_GUARD_BAND; }
    if (planes & VERTEX_RIGHT) != 0u { held.x = VERTEX_GUARD_BAND; }
    if (planes & VERTEX_TOP) != 0u { held.y = -VERTEX_GUARD_BAND; }
    if (planes & VERTEX_BOTTOM) != 0u { held.y = VERTEX_GUARD_BAND; }
    return held;
}

fn vertex_at(record: vec4u) -> vec2i {
    return bitcast<vec2i>(record.xy) >> vec2u(8u);
}
