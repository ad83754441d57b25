// Gate: is a covered sample drawn? The sample effects say first, then what a splat is of its triangle and the material's
// mask; the order counts what they left.
//@ use common/triangle
//@ use slot/samples
//@ use slot/splats
//@ use slot/mask
//@ use slot/order

fn is_drawn(t: Triangle, at: vec2u, pixel: u32) -> bool {
    return samples_is_drawn(t, at) && splats_is_drawn(t, at) && mask_is_drawn(t, at) && order_is_drawn(t, pixel);
}
