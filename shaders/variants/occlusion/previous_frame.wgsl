// Occlusion, previous frame: what the depths of the previous frame hide is left out, as if nothing had moved.
//@ use lib/meshlets
//@ use lib/extent
//@ use lib/hiz

fn occlusion_verdict(id: u32, draw: u32, box: Box, e: Extent) -> u32 {
    return select(CULL_VISIBLE, CULL_HIDDEN, hiz_hides(draw, box, e));
}
