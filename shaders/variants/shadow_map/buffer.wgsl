// Shadow map, buffer: the one in which the light's passes found the nearest depths, row by row.

@group(0) @binding(31) var<storage, read> shadow_map_keys: array<u32>;

fn shadow_map_key(texel: vec2u, side: u32) -> u32 { return shadow_map_keys[texel.y * side + texel.x]; }
