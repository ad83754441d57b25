// Texels, none: no material of the scene is more than a base colour.

fn texels_painted(surface: Surface, t: Triangle, at: vec3u, place: Place) -> Surface { return surface; }
