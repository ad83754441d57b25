// Occlusion, seen: the first round draws what was not hidden in the picture before. Whatever stands here, the second round
// makes it right.

@group(0) @binding(29) var<storage, read> meshlet_visibility: array<u32>;

fn occlusion_verdict(id: u32, draw: u32, box: Box, e: Extent) -> u32 {
    return select(CULL_WAITS, CULL_LEFT, meshlet_visibility[id] != 0u);
}
