// Keys, integer: depth at a sample as a quotient of integers, packed like a float. The same bits on every adapter, whatever the
// order of corners or the size class; ordered like the bits of a float, and never past the corners' depths.
//@ use common/fixed

// What a triangle's keys need.
struct Keys {
    z: vec3u,       // corner depths, fixed point: the nearest one's leading bit is bit 31
    exponent: i32,  // of the nearest corner, biased as a float's
    shift: u32,     // bits that edge functions are shifted down by, so that their sum fits 31
    depth: vec3f,   // z over that sum, for a guess
    share: f32,     // 1 over it
}

// For corner depths as the records have them, and the doubled area.
fn keys_begin(depths: vec3u, area: i32) -> Keys {
    return keys_begin_wide(depths, Wide(0u, u32(area)));
}

fn keys_begin_wide(depths: vec3u, area: Wide) -> Keys {
    // A depth that is subnormal or below 0 is 0.
    let exponents = select((depths >> vec3u(23u)) & vec3u(255u), vec3u(0u), depths >= vec3u(0x80000000u));
    let largest = max(max(exponents.x, exponents.y), exponents.z);
    let apart = vec3u(largest) - exponents;
    let significands = ((depths & vec3u(0x7fffffu)) | vec3u(0x800000u)) << vec3u(8u);
    let is_nothing = (apart > vec3u(31u)) | (exponents == vec3u(0u));
    let z = select(significands >> min(apart, vec3u(31u)), vec3u(0u), is_nothing);
    let shift = fixed_shift(area);
    let share = 1.0 / f32(fixed_down(area, shift));
    return Keys(z, i32(largest), shift, vec3f(z) * share, share);
}

// Bits 16 to 47 of a product, less what the low halves carry: see `keys_quotient`.
fn keys_middle(x: u32, y: u32) -> u32 {
    let xh = x >> 16u;
    let yh = y >> 16u;
    return (((x & 0xffffu) * (y & 0xffffu)) >> 16u) + (x & 0xffffu) * yh + xh * (y & 0xffffu) + ((xh * yh) << 16u);
}

// floor((e0 z0 + e1 z1 + e2 z2) / (e0 + e1 + e2)), where the sum of the edges is 1 to 2^31 - 1.
fn keys_quotient(keys: Keys, e: vec3u) -> u32 {
    let z = keys.z;
    let sum = e.x + e.y + e.z;
    // A float guesses, within 2^13 whatever it rounds; terms are positive, and no z is beyond 0xffffff00.
    let weights = vec3f(e);
    let guess = u32(min(weights.x * keys.depth.x + weights.y * keys.depth.y + weights.z * keys.depth.z, 4294967040.0));
    // What is left, |rest| < 2^45, from words that wrap: the lowest 32 bits of it, and bits 16 to 47.
    let low = e.x * z.x + e.y * z.y + e.z * z.z - guess * sum;
    let halves = ((e.x * z.x) & 0xffffu) + ((e.y * z.y) & 0xffffu) + ((e.z * z.z) & 0xffffu) + 0x10000u - ((guess * sum) & 0xffffu);
    let middle = keys_middle(e.x, z.x) + keys_middle(e.y, z.y) + keys_middle(e.z, z.z) - keys_middle(guess, sum) + (halves >> 16u) - 1u;
    let rest = f32(bitcast<i32>(middle)) * 65536.0 + f32(low & 0xffffu);
    // The second guess is within 0.6 of the quotient, so it is that or one more.
    let correction = i32(floor(rest * keys.share + 0.5));
    let left = bitcast<i32>(low - bitcast<u32>(correction) * sum);
    return guess + bitcast<u32>(correction) - select(0u, 1u, left < 0);
}

fn keys_packed(keys: Keys, quotient: u32) -> u32 {
    let zeros = countLeadingZeros(quotient);
    let exponent = keys.exponent - i32(zeros);
    let key = (u32(exponent) << 23u) | (((quotient << (zeros & 31u)) >> 8u) & 0x7fffffu);
    return select(key, 1u, quotient == 0u || exponent < 1);
}

// At a covered sample, from unbiased edge functions in i32.
fn keys_of(keys: Keys, edges: vec3i) -> u32 {
    return keys_packed(keys, keys_quotient(keys, vec3u(edges)));
}
