// Pixels, all: one workgroup of the resolve per 8x8 tile of the picture.

fn pixels_of(group: vec3u, groups: vec3u, local: vec2u) -> vec2u {
    return group.xy * 8u + local;
}
