// Discs, samples: draws the corners of a triangle on the spot.
//@ use common/points
//@ use slot/depth
//@ use common/gate
//@ use slot/visibility
//@ use slot/marks

fn discs_draw(t: Triangle, share: u32) {
    visibility_begin(t.id);
    var corners = array(t.a, t.b, t.c);
    for (var i = 0u; i < 3u; i += 1u) { discs_corner(t, corners[i], i, share); }
}

// The samples of one disc that belong to its corner, in every so many rows.
fn discs_corner(t: Triangle, corner: vec4u, place: u32, share: u32) {
    let pixels = points_pixels(corner);
    if any(pixels.zw < pixels.xy) { return; }
    marks_box(pixels);
    for (var y = pixels.y + i32(share); y <= pixels.w; y += i32(INVOCATIONS_PER_TRIANGLE)) {
        for (var x = pixels.x; x <= pixels.z; x += 1) {
            let pixel = u32(y) * frame.size.x + u32(x);
            if points_corner(t.a, t.b, t.c, grid_sample(vec2i(x, y))) == place && is_drawn(t, vec2u(vec2i(x, y)), pixel) {
                visibility_write(pixel, depth_key(bitcast<f32>(corner.z)), t.id);
            }
        }
    }
}
