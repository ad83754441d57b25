// Shading, nearest: the surface of the nearest triangle, after the surface effects.
//@ use lib/shade
//@ use glue/surface

fn shading_color(id: u32, pixel: vec2u) -> vec4f {
    shade_begin(id);
    return glue_surface(shade_surface(pixel), shaded.draw).color;
}
