// resolve: visits every pixel, or every pixel of the listed tiles; shades it, by its nearest triangle or by all its layers, and
// writes gamma-encoded bytes.
//@ use lib/frame
//@ use lib/color
//@ use lib/picture
//@ use variants/framebuffer_read
//@ use variants/shading
//@ use steps/finish_step

// Side of the square of pixels that a workgroup visits.
override TILE_SIDE: u32 = 8u;
// Only listed tiles are visited; the others show the background. Empty pixels are shaded too, with the first triangle, and the
// result is discarded: a CPU adapter executes both sides of every branch anyway, and loads what all invocations share only
// once outside branches.
override IS_BRANCHLESS: bool = false;

@compute @workgroup_size(TILE_SIDE, TILE_SIDE)
fn resolve(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u, @builtin(local_invocation_id) local: vec3u
) {
    let at = resolved_pixel(workgroup, workgroups, local.xy);
    let is_inside = all(at < frame.size);
    let pixel = min(at, frame.size - 1u);
    let found = framebuffer_load(pixel.y * frame.size.x + pixel.x);
    let has_triangle = found.x != 0u;
    background = background_of_row(pixel.y);
    var encoded = background;
    if IS_BRANCHLESS || (is_inside && has_triangle) {
        let shaded = shading_color(select(0u, ~found.x, has_triangle), pixel);
        encoded = select(encoded, vec4f(color_encode(shaded.rgb), shaded.a), has_triangle);
    }
    if is_inside {
        color[pixel.y * frame.stride + pixel.x] = color_pack(finish_step(encoded, pixel));
        if !has_triangle && found.y != 0u { atomicAdd(&counters.depth_without_id, 1u); }
    }
}

fn resolved_pixel(workgroup: vec3u, workgroups: vec3u, local: vec2u) -> vec2u {
    if !IS_BRANCHLESS { return workgroup.xy * TILE_SIDE + local; }
    let tile = color[tile_list() + workgroup.y * workgroups.x + workgroup.x];
    let width = (frame.size.x + TILE_SIDE - 1u) / TILE_SIDE;
    return vec2u(tile % width, tile / width) * TILE_SIDE + local;
}
