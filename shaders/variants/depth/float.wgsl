// Depth, float: corner depths are weighted by the edge functions as floats and clamped to the range of the corners. DEPTH_FORMAT
// tells how a depth becomes a key.
//@ use lib/fixed

// 0 reversed, 1 standard, 2 ndc16, 3 logarithmic.
override DEPTH_FORMAT: u32 = 0u;
// Distance of logarithmic keys, in steps of a float's bits: 16 for 24 bits, 4096 for 16 bits.
override DEPTH_LOG_STEP: u32 = 16u;

const DEPTH_STANDARD = 1u;
const DEPTH_NDC16 = 2u;
const DEPTH_LOG = 3u;

const DEPTH_LOG_FIRST = 0x30000000u; // bits of 2^-31: logarithmic keys cover five bits of the exponent, 2^-31 to 1

fn depth_key(z: f32) -> u32 {
    // A conventional float depth, 0 at the near plane and 1 far away, turned so that larger is nearer. Its keys crowd far away.
    if DEPTH_FORMAT == DEPTH_STANDARD { return 0x3f800001u - bitcast<u32>(clamp(1.0 - z, 0.0, 1.0)); }
    // 16 bits, evenly spaced in normalized device depth.
    if DEPTH_FORMAT == DEPTH_NDC16 { return max(u32(clamp(z, 0.0, 1.0) * 65535.0 + 0.5), 1u); }
    // A float's bits are a logarithm already: exponent and fraction, cut to 16 or 24 bits.
    if DEPTH_FORMAT == DEPTH_LOG {
        return max(max(bitcast<u32>(z), DEPTH_LOG_FIRST) - DEPTH_LOG_FIRST, DEPTH_LOG_STEP) / DEPTH_LOG_STEP;
    }
    // Reversed: the bits of the float. Floats are densest near 0, where perspective depths crowd.
    return max(bitcast<u32>(z), 1u);
}

fn depth_bits(key: u32) -> u32 {
    if DEPTH_FORMAT == DEPTH_STANDARD { return max(bitcast<u32>(1.0 - bitcast<f32>(0x3f800001u - key)), 1u); }
    // A product is rounded correctly everywhere, a quotient is not.
    if DEPTH_FORMAT == DEPTH_NDC16 { return bitcast<u32>(f32(key) * (1.0 / 65535.0)); }
    if DEPTH_FORMAT == DEPTH_LOG { return DEPTH_LOG_FIRST + key * DEPTH_LOG_STEP; }
    return key;
}

struct DepthPlane {
    depth: vec3f,   // corner depths over the doubled area
    range: vec2f,   // smallest and largest corner depth
}

fn depth_plane_of(z: vec3f, area: f32) -> DepthPlane {
    return DepthPlane(z * (1.0 / area), vec2f(min(min(z.x, z.y), z.z), max(max(z.x, z.y), z.z)));
}

fn depth_plane(depths: vec3u, area: i32) -> DepthPlane {
    return depth_plane_of(bitcast<vec3f>(depths), f32(area));
}

fn depth_plane_wide(depths: vec3u, area: Wide) -> DepthPlane {
    return depth_plane_of(bitcast<vec3f>(depths), fixed_to_f32(area));
}

fn depth_weighted(plane: DepthPlane, weights: vec3f) -> u32 {
    let z = weights.x * plane.depth.x + weights.y * plane.depth.y + weights.z * plane.depth.z;
    return depth_key(clamp(z, plane.range.x, plane.range.y));
}

fn depth_at(plane: DepthPlane, edges: vec3i) -> u32 {
    return depth_weighted(plane, vec3f(edges));
}

fn depth_range(plane: DepthPlane) -> vec2u {
    return vec2u(depth_key(plane.range.x), depth_key(plane.range.y));
}
