// Resolve: one visit per pixel. Shades it, by its triangle id or by all its layers, and writes gamma-encoded bytes.
//@ use common/color
//@ use common/picture
//@ use common/counters
//@ use slot/owner
//@ use slot/pixels
//@ use slot/dots
//@ use slot/finish
//@ use slot/shading

// Empty pixels are computed too, with the first triangle, and thrown away: a CPU adapter executes both sides of every
// branch anyway, and loads what all lanes share only once outside of branches.
override IS_BRANCHLESS: bool = false;

@compute @workgroup_size(TILE_SIDE, TILE_SIDE)
fn resolve(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let at = pixels_of(group, groups, local.xy);
    let is_inside = all(at < frame.size);
    let pixel = min(at, frame.size - 1u);
    let found = owner_load(pixel.y * frame.size.x + pixel.x);
    let is_owned = found.x != 0u;
    var encoded = frame.background;
    if IS_BRANCHLESS || (is_inside && is_owned) {
        let shaded = shading_color(select(0u, ~found.x, is_owned), pixel);
        encoded = select(encoded, vec4f(color_encode(shaded.rgb), shaded.a), is_owned);
    }
    if is_inside {
        color[pixel.y * frame.stride + pixel.x] = color_pack(finish(pixel, dots_over(pixel, encoded)));
        if !is_owned && found.y != 0u { atomicAdd(&counters.depth_without_id, 1u); }
    }
}
