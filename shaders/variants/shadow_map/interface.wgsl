// Shadow map: where the depths lie that the light sees.
// Chosen by the adapter: buffer where a kernel may bind enough storage buffers, so that nothing is copied, else texture. Default: texture.
//
// Depth key of a texel, which lies inside a map of `side` texels a side.
//@ declare fn shadow_map_key(texel: vec2u, side: u32) -> u32
