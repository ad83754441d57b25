// Occlusion, early: the first of two phases draws what was visible in the previous frame. `meshlet_visibility` may hold
// anything: the late phase corrects it.
//@ use lib/meshlets
//@ use lib/extent

@group(0) @binding(29) var<storage, read> meshlet_visibility: array<u32>;

fn occlusion_verdict(id: u32, draw: u32, box: Box, e: Extent) -> u32 {
    return select(CULL_OTHER_PHASE, CULL_VISIBLE, meshlet_visibility[id] != 0u);
}
