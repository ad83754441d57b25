// Where a place in the finished picture looks. Mirrors `effects::hooks::ImageAt::direction`.
//@ use lib/frame
//@ use lib/geometry

// The unit vector from the eye, world space, to a place in pixels from the top left corner.
fn image_direction(x: f32, y: f32) -> vec3f {
    if !IS_PERSPECTIVE { return frame.forward.xyz; }
    let place = vec2f(x, y) / vec2f(frame.size) * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    return normalize(frame.forward.xyz + place.x * frame.ndc_x.xyz + place.y * frame.ndc_y.xyz);
}
