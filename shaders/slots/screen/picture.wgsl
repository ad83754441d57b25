// Screen, picture: a light draws, but effects ask where something stands in the picture that it lights.
//@ use common/center

// Where a place of the world stands in the picture, 0 to 1, given where it stands in what is being drawn.
fn screen_of(center: vec3f, own: vec2f) -> vec2f {
    let clip = frame.picture_from_world * vec4f(center, 1.0);
    return center_clipped(clip, clip, clip, vec2f(0.5));
}
