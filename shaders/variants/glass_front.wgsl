// Glass front: the nearest triangle of a pixel, opaque until the layers of glass before it are composed, then the first of these.
// Chosen by the layout of the framebuffer (accuracy axis `visibility`). Default: split32.
//
// What the framebuffer holds of it, and in y its complemented id, 0 for none.
//@ declare fn glass_front_load(pixel: u32) -> vec2u
// Is a sample nearer than the triangle of which that was loaded? Of equal keys the smaller id is.
//@ declare fn glass_front_is_behind(front: vec2u, key: u32, id: u32) -> bool
//@ declare fn glass_front_store(pixel: u32, key: u32, id: u32)

//@ variant split32
// Keys and ids in two buffers.
//@ binding @group(0) @binding(5) var<storage, read_write> depth_keys: array<atomic<u32>>;
//@ binding @group(0) @binding(6) var<storage, read_write> triangle_ids: array<u32>;

fn glass_front_load(pixel: u32) -> vec2u { return vec2u(atomicLoad(&depth_keys[pixel]), triangle_ids[pixel]); }

fn glass_front_is_behind(front: vec2u, key: u32, id: u32) -> bool {
    return key > front.x || (key == front.x && ~id > front.y);
}

fn glass_front_store(pixel: u32, key: u32, id: u32) {
    atomicStore(&depth_keys[pixel], key);
    triangle_ids[pixel] = ~id;
}

//@ variant packed32
// One word, whose order is that of its pixel's opaque triangles.
//@ use lib/packed32
//@ binding @group(0) @binding(5) var<storage, read_write> packed: array<atomic<u32>>;

fn glass_front_load(pixel: u32) -> vec2u {
    let word = atomicLoad(&packed[pixel]);
    return vec2u(word, select(packed32_unpacked(word).x, 0u, word == 0u));
}

fn glass_front_is_behind(front: vec2u, key: u32, id: u32) -> bool { return packed32_word(key, id) > front.x; }

fn glass_front_store(pixel: u32, key: u32, id: u32) { atomicStore(&packed[pixel], packed32_word(key, id)); }

//@ variant packed64
// The halves of a 64-bit word.
//@ binding @group(0) @binding(5) var<storage, read_write> depth_and_id: array<atomic<u32>>;

fn glass_front_load(pixel: u32) -> vec2u {
    return vec2u(atomicLoad(&depth_and_id[2u * pixel + 1u]), atomicLoad(&depth_and_id[2u * pixel]));
}

fn glass_front_is_behind(front: vec2u, key: u32, id: u32) -> bool {
    return key > front.x || (key == front.x && ~id > front.y);
}

fn glass_front_store(pixel: u32, key: u32, id: u32) {
    atomicStore(&depth_and_id[2u * pixel + 1u], key);
    atomicStore(&depth_and_id[2u * pixel], ~id);
}
