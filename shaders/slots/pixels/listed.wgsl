// Pixels, listed: one workgroup of the resolve per marked tile; the others keep the background.
//@ use common/picture

fn pixels_of(group: vec3u, groups: vec3u, local: vec2u) -> vec2u {
    let tile = color[picture_first_listed() + group.y * groups.x + group.x];
    let width = (frame.size.x + TILE_SIDE - 1u) / TILE_SIDE;
    return vec2u(tile % width, tile / width) * TILE_SIDE + local;
}
