// X-ray buffer, packed64 in pairs: behind the 64-bit words, two words of sums in one addition. The lower word of a pair overflows into the
// upper one only on pixels whose sums are full, and that is seen before it happens; one64 is one integer to begin with.
//@ use lib/frame
//@ use lib/xray_sums

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<atomic<u64>>;

fn xray_buffer_nearest(pixel: u32, key: u32, id: u32) {
    atomicMax(&depth_and_id[pixel], (u64(key) << 32u) | u64(~id));
}

fn xray_buffer_front(pixel: u32) -> u32 {
    return u32(atomicLoad(&depth_and_id[pixel]) >> 32u);
}

fn xray_buffer_add(pixel: u32, layer: vec4u) -> vec4u {
    let first = frame.size.x * frame.size.y + SUM_WORDS / 2u * pixel;
    let low = add_pair(first, layer.xy);
    if SUM_WORDS == 2u { return vec4u(low, 0u, 0u); }
    return vec4u(low, add_pair(first + 1u, layer.zw));
}

fn add_pair(index: u32, words: vec2u) -> vec2u {
    let before = atomicAdd(&depth_and_id[index], u64(words.x) | (u64(words.y) << 32u));
    return vec2u(u32(before), u32(before >> 32u));
}
