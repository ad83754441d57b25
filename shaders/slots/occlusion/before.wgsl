// Occlusion, before: what the picture before this one hides is left out, as if nothing had moved.
//@ use common/hiz

fn occlusion_verdict(id: u32, draw: u32, box: Box, e: Extent) -> u32 {
    return select(CULL_LEFT, CULL_HIDDEN, hiz_hides(draw, box, e));
}
