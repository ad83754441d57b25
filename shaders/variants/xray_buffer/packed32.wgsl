// X-ray buffer, packed32: behind the packed words, which keep only a part of the front's key.
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
