// Dots, none: nothing is drawn over the surfaces.

fn dots_over(pixel: vec2u, encoded: vec4f) -> vec4f { return encoded; }
