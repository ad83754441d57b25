// Owner of a finished pixel, from the halves of packed64's words.

@group(0) @binding(5) var<storage, read> depth_owner: array<vec2u>;

// x: complemented id, 0 where empty. y: depth key.
fn owner_load(pixel: u32) -> vec2u {
    return depth_owner[pixel];
}
