// glass_compose: composes the layers of glass of every pixel of a band in linear light, but for what the opaque triangle hides. The
// nearest layer then stands for the pixel in the framebuffer.
//@ use lib/frame
//@ use lib/glass
//@ use lib/glass_band
//@ use lib/glass_list
//@ use variants/glass_buffer
//@ use variants/glass_composition
//@ use variants/glass_front

// Most layers of a pixel that are composed: a CPU adapter ends all loops of an invocation after 65,535 iterations.
override GLASS_DEEPEST: u32 = 0xffffffffu;

@compute @workgroup_size(64)
fn glass_compose(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let index = frame_invocation(workgroup, workgroups, invocation_index, 64u);
    let pixel = glass_band_first() + index;
    if index >= glass_band_length() || pixel >= frame.size.x * frame.size.y { return; }
    let head = glass_buffer_load(pixel);
    if head == 0u { return; }
    if glass_is_deep(head) {
        glass_buffer_add(glass_counts() + GLASS_COUNT_DEEP, 1u);
        glass_buffer_store(pixel, 0u);
        return;
    }
    let seen = glass_composition(pixel, head);
    glass_buffer_store(pixel, seen.first);
    if seen.first == 0u { return; }
    let composed = glass_composed(pixel);
    let words = glass_packed(seen.layer);
    glass_buffer_store(composed, glass_front_id(pixel));
    glass_buffer_store(composed + 1u, words.x);
    glass_buffer_store(composed + 2u, words.y);
    glass_buffer_store(composed + 3u, words.z);
    glass_front_store(pixel, glass_key(seen.first), glass_id(seen.first));
}

// Has a list more layers than are composed?
fn glass_is_deep(head: u32) -> bool {
    if GLASS_DEEPEST == 0xffffffffu { return false; }
    var link = head;
    for (var count = 0u; count < GLASS_DEEPEST; count += 1u) {
        if link == 0u { return false; }
        link = glass_next(link);
    }
    return link != 0u;
}
