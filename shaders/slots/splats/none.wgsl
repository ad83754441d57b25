// Splats, none: triangles are drawn whole.

fn splats_is_drawn(t: Triangle, at: vec2u) -> bool {
    return true;
}
