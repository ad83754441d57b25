// glass_compose: composes the layers of glass of every pixel of a band in linear light, but for what the opaque triangle hides. The
// nearest layer then stands for the pixel in the framebuffer. Heads of more than one band are left empty for the next one.
//@ use lib/frame
//@ use lib/glass
//@ use lib/glass_band
//@ use lib/glass_composed
//@ use lib/glass_list
//@ use variants/glass_buffer
//@ use variants/glass_composition
//@ use variants/glass_front

@compute @workgroup_size(64)
fn glass_compose(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let index = frame_invocation(workgroup, workgroups, invocation_index, 64u);
    let pixel = glass_band_first() + index;
    if index >= glass_band_length() || pixel >= frame.size.x * frame.size.y { return; }
    let front = glass_front_load(pixel);
    glass_buffer_store(glass_opaque(pixel), front.y);
    let head = glass_buffer_load(index);
    if head == 0u { return; }
    let seen = glass_composition(front, head);
    if seen.is_deep { glass_buffer_add(glass_counts() + GLASS_COUNT_DEEP, 1u); }
    glass_buffer_store(index, select(0u, seen.first, GLASS_BANDS == 1u));
    if seen.first == 0u { return; }
    glass_composed_store(pixel, seen.layer);
    glass_front_store(pixel, glass_key(seen.first), glass_id(seen.first));
}
