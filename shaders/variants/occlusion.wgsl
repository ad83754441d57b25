// Occlusion: which meshlets that pass the other tests are hidden.
// Chosen by the culling phase.
//
// CULL_VISIBLE, CULL_HIDDEN or CULL_OTHER_PHASE, for a meshlet counted over all instances.
//@ declare fn occlusion_verdict(id: u32, draw: u32, box: Box, e: Extent) -> u32

//@ variant default
// Nothing hides anything.
//@ use lib/meshlets
//@ use lib/extent

fn occlusion_verdict(id: u32, draw: u32, box: Box, e: Extent) -> u32 {
    return CULL_VISIBLE;
}

//@ variant previous_frame
// What the depths of the previous frame hide is left out, as if nothing had moved.
//@ use lib/meshlets
//@ use lib/extent
//@ use lib/hiz

fn occlusion_verdict(id: u32, draw: u32, box: Box, e: Extent) -> u32 {
    return select(CULL_VISIBLE, CULL_HIDDEN, hiz_hides(draw, box, e));
}

//@ variant early
// The first of two phases draws what was visible in the previous frame. `meshlet_visibility` may hold
// anything: the late phase corrects it.
//@ use lib/meshlets
//@ use lib/extent

@group(0) @binding(29) var<storage, read> meshlet_visibility: array<u32>;

fn occlusion_verdict(id: u32, draw: u32, box: Box, e: Extent) -> u32 {
    return select(CULL_OTHER_PHASE, CULL_VISIBLE, meshlet_visibility[id] != 0u);
}

//@ variant late
// The second of two phases draws what the first neither drew nor hides, and records what is visible now.
//@ use lib/meshlets
//@ use lib/extent
//@ use lib/hiz

@group(0) @binding(29) var<storage, read_write> meshlet_visibility: array<u32>;

fn occlusion_verdict(id: u32, draw: u32, box: Box, e: Extent) -> u32 {
    let is_drawn = meshlet_visibility[id] != 0u;
    let is_hidden = hiz_hides(draw, box, e);
    meshlet_visibility[id] = select(1u, 0u, is_hidden);
    return select(select(CULL_VISIBLE, CULL_HIDDEN, is_hidden), CULL_OTHER_PHASE, is_drawn);
}
