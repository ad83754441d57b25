// Shadow map: where the depths lie that the light sees.
// Chosen by the adapter: buffer where a kernel may bind enough storage buffers, so that nothing is copied, else texture. Default: texture.
//
// Depth key of a texel, which lies inside a map of `side` texels a side.
//@ declare fn shadow_map_key(texel: vec2u, side: u32) -> u32

//@ variant texture
// A copy of the light's nearest depths, which takes none of the few storage buffers that a kernel may bind.

@group(0) @binding(31) var shadow_map: texture_2d<u32>;

fn shadow_map_key(texel: vec2u, side: u32) -> u32 { return textureLoad(shadow_map, texel, 0).x; }

//@ variant buffer
// The one in which the light's passes found the nearest depths, row by row.

@group(0) @binding(31) var<storage, read> shadow_map_keys: array<u32>;

fn shadow_map_key(texel: vec2u, side: u32) -> u32 { return shadow_map_keys[texel.y * side + texel.x]; }
