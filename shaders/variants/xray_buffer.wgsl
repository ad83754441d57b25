// X-ray buffer: sums of each pixel's layers, which stand behind the pixels of the framebuffer: portable adapters bind eight
// storage buffers to a pass, and raster_medium has no ninth.
// Chosen by the layout of the framebuffer (accuracy axis `visibility`); packed64_pairs where words come in pairs and the adapter adds
// 64 bits at once. Default: split32.
//
// Takes a sample for the nearest of its pixel if it is; without packed64_pairs other passes find the nearest.
//@ declare fn xray_buffer_nearest(pixel: u32, key: u32, id: u32)
// Depth key of a pixel's front.
//@ declare fn xray_buffer_front(pixel: u32) -> u32
// Adds a layer's words to the sums of a pixel and returns their values before.
//@ declare fn xray_buffer_add(pixel: u32, layer: vec4u) -> vec4u

//@ variant split32
// Behind the depth keys.
//@ use lib/frame
//@ use lib/xray_sums

@group(0) @binding(5) var<storage, read_write> depth_keys: array<atomic<u32>>;

fn xray_buffer_nearest(pixel: u32, key: u32, id: u32) {}

fn xray_buffer_front(pixel: u32) -> u32 {
    return atomicLoad(&depth_keys[pixel]);
}

fn xray_buffer_add(pixel: u32, layer: vec4u) -> vec4u {
    let first = frame.size.x * frame.size.y + SUM_WORDS * pixel;
    var before: vec4u;
    for (var i = 0u; i < SUM_WORDS; i += 1u) { before[i] = atomicAdd(&depth_keys[first + i], layer[i]); }
    return before;
}

//@ variant packed32
// Behind the packed words, which keep only a part of the front's key.
//@ use lib/frame
//@ use lib/xray_sums
//@ use lib/packed32

@group(0) @binding(5) var<storage, read_write> packed: array<atomic<u32>>;

fn xray_buffer_nearest(pixel: u32, key: u32, id: u32) {}

fn xray_buffer_front(pixel: u32) -> u32 {
    return packed32_unpacked(atomicLoad(&packed[pixel])).y;
}

fn xray_buffer_add(pixel: u32, layer: vec4u) -> vec4u {
    let first = frame.size.x * frame.size.y + SUM_WORDS * pixel;
    var before: vec4u;
    for (var i = 0u; i < SUM_WORDS; i += 1u) { before[i] = atomicAdd(&packed[first + i], layer[i]); }
    return before;
}

//@ variant packed64
// Behind the 64-bit words, which are read as halves.
//@ use lib/frame
//@ use lib/xray_sums

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<atomic<u32>>;

fn xray_buffer_nearest(pixel: u32, key: u32, id: u32) {}

fn xray_buffer_front(pixel: u32) -> u32 {
    return atomicLoad(&depth_and_id[2u * pixel + 1u]);
}

fn xray_buffer_add(pixel: u32, layer: vec4u) -> vec4u {
    let first = 2u * frame.size.x * frame.size.y + SUM_WORDS * pixel;
    var before: vec4u;
    for (var i = 0u; i < SUM_WORDS; i += 1u) { before[i] = atomicAdd(&depth_and_id[first + i], layer[i]); }
    return before;
}

//@ variant packed64_pairs
// Behind the 64-bit words, two words of sums in one addition. The lower word of a pair overflows into the
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
