// Keys, float: corner depths weighted by the edge functions as floats, held between the corners'.
//@ use common/fixed
//@ use slot/depth

// What a triangle's keys need.
struct Keys {
    depth: vec3f,   // corner depths over the doubled area
    range: vec2f,   // smallest and largest corner depth
}

fn keys_for(z: vec3f, area: f32) -> Keys {
    return Keys(z * (1.0 / area), vec2f(min(min(z.x, z.y), z.z), max(max(z.x, z.y), z.z)));
}

// For corner depths as the records have them, and the doubled area.
fn keys_begin(depths: vec3u, area: i32) -> Keys {
    return keys_for(bitcast<vec3f>(depths), f32(area));
}

fn keys_begin_wide(depths: vec3u, area: Wide) -> Keys {
    return keys_for(bitcast<vec3f>(depths), fixed_to_f32(area));
}

fn keys_weighted(keys: Keys, weights: vec3f) -> u32 {
    let z = weights.x * keys.depth.x + weights.y * keys.depth.y + weights.z * keys.depth.z;
    return depth_key(clamp(z, keys.range.x, keys.range.y));
}

// At a covered sample, from unbiased edge functions in i32.
fn keys_of(keys: Keys, edges: vec3i) -> u32 {
    return keys_weighted(keys, vec3f(edges));
}
