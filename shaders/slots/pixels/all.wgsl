// Pixels, all: one workgroup of the resolve per tile of the picture.
//@ use common/frame

fn pixels_of(group: vec3u, groups: vec3u, local: vec2u) -> vec2u {
    return group.xy * TILE_SIDE + local;
}
