// image_pass: one pass of one image effect over all pixels of the picture, or of a half or a quarter of its size.
//@ use lib/image_pass
//@ use lib/attributes
//@ use glue/image_pass
//@ use variants/image_store

@compute @workgroup_size(8, 8)
fn image_pass(@builtin(global_invocation_id) global: vec3u) {
    let size = image_size_at(IMAGE_SCALE);
    if any(global.xy >= size) { return; }
    let at = ImageAt(i32(global.x), i32(global.y), size, IMAGE_SCALE);
    image_store(global.xy, size.x, image_finite(glue_image_pass(at)));
}

// A channel that is NaN or infinite is 0, so that no pass spreads it. Compilers may assume floats to be finite, so the bits are tested.
fn image_finite(color: vec4f) -> vec4f {
    return select(color, vec4f(0.0), (bitcast<vec4u>(color) & vec4u(FLOAT_EXPONENT)) == vec4u(FLOAT_EXPONENT));
}
