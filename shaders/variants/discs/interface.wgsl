// Discs: what raster_points does with the discs about a triangle's corners.
// Chosen by the raster phase: tiles where triangles are put on the lists of tiles. Default: the functions below, which draw
// the samples at once.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/shape
//@ use variants/depth
//@ use variants/framebuffer_write
//@ use steps/sample_test
//@ use steps/mark_tiles

// `part`: 0 to INVOCATIONS_PER_TRIANGLE - 1, which rows of the discs this invocation draws.
//@ declare fn discs(t: Triangle, part: u32)
fn discs(t: Triangle, part: u32) {
    framebuffer_begin(t.id);
    var corners = array(t.a, t.b, t.c);
    for (var i = 0u; i < 3u; i += 1u) { discs_corner(t, corners[i], i, part); }
}

// The samples of one disc that belong to its corner.
fn discs_corner(t: Triangle, corner: vec4u, index: u32, part: u32) {
    let pixels = disc_pixels(corner);
    if any(pixels.zw < pixels.xy) { return; }
    mark_tiles(pixels);
    for (var y = pixels.y + i32(part); y <= pixels.w; y += i32(INVOCATIONS_PER_TRIANGLE)) {
        for (var x = pixels.x; x <= pixels.z; x += 1) {
            let pixel = u32(y) * frame.size.x + u32(x);
            if disc_corner(t.a, t.b, t.c, grid_sample(vec2i(x, y))) == index && sample_test(t, vec2u(vec2i(x, y)), pixel) {
                framebuffer_write(pixel, depth_key(bitcast<f32>(corner.z)), t.id);
            }
        }
    }
}
