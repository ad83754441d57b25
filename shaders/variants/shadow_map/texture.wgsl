// Shadow map, texture: a copy of the light's nearest depths, which takes none of the few storage buffers that a kernel may bind.

@group(0) @binding(31) var shadow_map: texture_2d<u32>;

fn shadow_map_key(texel: vec2u, side: u32) -> u32 { return textureLoad(shadow_map, texel, 0).x; }
