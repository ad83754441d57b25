// Depth: keys of reversed depths, which are 1 at the near plane and 0 far away, and their interpolation over a triangle. A
// larger key is nearer; every key is at least 1.
// Chosen by the accuracy axis `depth`. Default: float.
//
// Key of a reversed depth from 0 to 1.
//@ declare fn depth_key(z: f32) -> u32
// Bits of the reversed depth that a key stands for.
//@ declare fn depth_bits(key: u32) -> u32
// The depths of a triangle, for interpolation.
//@ declare struct DepthPlane
// From the bits of the corner depths, and twice the area of the triangle.
//@ declare fn depth_plane(depths: vec3u, area: i32) -> DepthPlane
//@ declare fn depth_plane_wide(depths: vec3u, area: Wide) -> DepthPlane
// Key at a covered sample, from unbiased edge functions.
//@ declare fn depth_at(plane: DepthPlane, edges: vec3i) -> u32
// The farthest and the nearest key of any sample: those of corners.
//@ declare fn depth_range(plane: DepthPlane) -> vec2u
//
// variants/large_depth is chosen along with this, and uses more of each: `depth_weighted(plane, weights: vec3f)` of float,
// `depth_quotient` and `depth_packed` of integer.
//@ may declare fn depth_weighted
//@ may declare fn depth_quotient
//@ may declare fn depth_packed

//@ variant float
// Corner depths are weighted by the edge functions as floats and clamped to the range of the corners. DEPTH_FORMAT
// tells how a depth becomes a key.
//@ use lib/fixed

// 0 reversed, 1 standard, 2 ndc16, 3 logarithmic.
override DEPTH_FORMAT: u32 = 0u;
// Distance of logarithmic keys, in steps of a float's bits: 16 for 24 bits, 4096 for 16 bits.
override DEPTH_LOG_STEP: u32 = 16u;

const DEPTH_STANDARD = 1u;
const DEPTH_NDC16 = 2u;
const DEPTH_LOG = 3u;

const DEPTH_ABOVE_ONE = 0x3f800001u; // bits of the least float above 1
const DEPTH_LOG_FIRST = 0x30000000u; // bits of 2^-31: logarithmic keys cover five bits of the exponent, 2^-31 to 1

fn depth_key(z: f32) -> u32 {
    // A conventional float depth, 0 at the near plane and 1 far away, turned so that larger is nearer. Its keys crowd far away.
    if DEPTH_FORMAT == DEPTH_STANDARD { return DEPTH_ABOVE_ONE - bitcast<u32>(clamp(1.0 - z, 0.0, 1.0)); }
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
    if DEPTH_FORMAT == DEPTH_STANDARD { return max(bitcast<u32>(1.0 - bitcast<f32>(DEPTH_ABOVE_ONE - key)), 1u); }
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

//@ variant integer
// The depth at a sample is a quotient of integers, packed like a float: the same bits on every adapter, for
// every order of corners and every size of the triangle. Keys order like the bits of a float, never leave the range of the corners'
// depths, and are a corner's bits at the corner.
//@ use lib/fixed

fn depth_key(z: f32) -> u32 {
    return max(bitcast<u32>(z), 1u);
}

fn depth_bits(key: u32) -> u32 {
    return key;
}

struct DepthPlane {
    z: vec3u,       // corner depths, fixed point: the nearest one's leading bit is bit 31
    exponent: i32,  // of the nearest corner, biased as in a float
    shift: u32,     // bits by which edge functions are shifted down, so that their sum fits 31 bits
    depth: vec3f,   // z over that sum, for an estimate
    inverse: f32,   // 1 over that sum
}

fn depth_plane(depths: vec3u, area: i32) -> DepthPlane {
    return depth_plane_wide(depths, Wide(0u, u32(area)));
}

fn depth_plane_wide(depths: vec3u, area: Wide) -> DepthPlane {
    // A depth that is subnormal or below 0 is 0.
    let exponents = select((depths >> vec3u(23u)) & vec3u(255u), vec3u(0u), depths >= vec3u(0x80000000u));
    let largest = max(max(exponents.x, exponents.y), exponents.z);
    let apart = vec3u(largest) - exponents;
    let significands = ((depths & vec3u(0x7fffffu)) | vec3u(0x800000u)) << vec3u(8u);
    let is_zero = (apart > vec3u(31u)) | (exponents == vec3u(0u));
    let z = select(significands >> min(apart, vec3u(31u)), vec3u(0u), is_zero);
    let shift = fixed_shift(area);
    let inverse = 1.0 / f32(fixed_down(area, shift));
    return DepthPlane(z, i32(largest), shift, vec3f(z) * inverse, inverse);
}

// Bits 16 to 47 of a product, without the carry from the low halves: see `depth_quotient`.
fn depth_middle(x: u32, y: u32) -> u32 {
    let xh = x >> 16u;
    let yh = y >> 16u;
    return (((x & 0xffffu) * (y & 0xffffu)) >> 16u) + (x & 0xffffu) * yh + xh * (y & 0xffffu) + ((xh * yh) << 16u);
}

// floor((e0 z0 + e1 z1 + e2 z2) / (e0 + e1 + e2)), where the sum of the edges is 1 to 2^31 - 1.
fn depth_quotient(plane: DepthPlane, e: vec3u) -> u32 {
    let z = plane.z;
    let sum = e.x + e.y + e.z;
    // Estimated in f32, within 2^13 in spite of rounding: terms are positive, and no z is above 0xffffff00.
    let weights = vec3f(e);
    let estimate = u32(min(weights.x * plane.depth.x + weights.y * plane.depth.y + weights.z * plane.depth.z, 4294967040.0));
    // The remainder, |rest| < 2^45, from words that wrap: its lowest 32 bits, and bits 16 to 47.
    let low = e.x * z.x + e.y * z.y + e.z * z.z - estimate * sum;
    let halves = ((e.x * z.x) & 0xffffu) + ((e.y * z.y) & 0xffffu) + ((e.z * z.z) & 0xffffu) + 0x10000u - ((estimate * sum) & 0xffffu);
    let middle = depth_middle(e.x, z.x) + depth_middle(e.y, z.y) + depth_middle(e.z, z.z) - depth_middle(estimate, sum)
        + (halves >> 16u) - 1u;
    let rest = f32(bitcast<i32>(middle)) * 65536.0 + f32(low & 0xffffu);
    // The corrected estimate is within 0.6 of the quotient, so it is the quotient or one more.
    let correction = i32(floor(rest * plane.inverse + 0.5));
    let left = bitcast<i32>(low - bitcast<u32>(correction) * sum);
    return estimate + bitcast<u32>(correction) - select(0u, 1u, left < 0);
}

fn depth_packed(plane: DepthPlane, quotient: u32) -> u32 {
    let zeros = countLeadingZeros(quotient);
    let exponent = plane.exponent - i32(zeros);
    let key = (u32(exponent) << 23u) | (((quotient << (zeros & 31u)) >> 8u) & 0x7fffffu);
    return select(key, 1u, quotient == 0u || exponent < 1);
}

fn depth_at(plane: DepthPlane, edges: vec3i) -> u32 {
    return depth_packed(plane, depth_quotient(plane, vec3u(edges)));
}

fn depth_range(plane: DepthPlane) -> vec2u {
    let z = plane.z;
    return vec2u(depth_packed(plane, min(min(z.x, z.y), z.z)), depth_packed(plane, max(max(z.x, z.y), z.z)));
}
