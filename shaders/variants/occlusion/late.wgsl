// Occlusion, late: the second of two phases draws what the first neither drew nor hides, and records what is visible now.
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
