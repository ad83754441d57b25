// Mask, none: no material of the scene leaves samples out.

fn mask_is_drawn(t: Triangle, at: vec2u) -> bool { return true; }

fn mask_settle(t: Triangle, at: vec3u) {}
