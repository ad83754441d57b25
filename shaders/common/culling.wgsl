// Culling: how many meshlets there are, counted once for every instance, and where those that are left are listed. Mirror of
// `gpu::culling::CullingUniform`.

struct Culling {
    meshlet_count: u32,
    first_visible: u32,  // word of `meshlet_lists`
    hiz_width: u32,       // tiles of 8x8 pixels in a row of the depths that hide, in whole blocks of 64x64
    hiz_first_block: u32, // word at which those of the blocks begin
}

@group(0) @binding(25) var<uniform> culling: Culling;

// Invocations for the triangles of a meshlet.
override MESHLET_TRIANGLES: u32 = 64u;

// Draw, first triangle, first vertex, numbers of both.
const VISIBLE_MESHLET_WORDS = 4u;
