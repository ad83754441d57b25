// Occlusion: which meshlets that pass the other tests are hidden.
// Chosen by the culling phase. Default: the function below, where nothing hides anything.
//@ use lib/meshlets
//@ use lib/extent

// CULL_VISIBLE, CULL_HIDDEN or CULL_OTHER_PHASE, for a meshlet counted over all instances.
//@ declare fn occlusion_verdict(id: u32, draw: u32, box: Box, e: Extent) -> u32
fn occlusion_verdict(id: u32, draw: u32, box: Box, e: Extent) -> u32 {
    return CULL_VISIBLE;
}
