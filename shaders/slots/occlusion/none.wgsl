// Occlusion, none: nothing hides anything.

fn occlusion_verdict(id: u32, draw: u32, box: Box, e: Extent) -> u32 {
    return CULL_LEFT;
}
