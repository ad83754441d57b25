// Screen, own: where something stands in the picture that is being drawn.

// Where a place of the world stands in the picture, 0 to 1, given where it stands in what is being drawn.
fn screen_of(center: vec3f, own: vec2f) -> vec2f { return own; }
