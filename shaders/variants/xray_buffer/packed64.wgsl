// X-ray buffer, packed64: behind the 64-bit words, which are read as halves.
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
