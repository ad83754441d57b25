// Shading, triangle id: a pixel shows the surface of the triangle that owns it, rebuilt at the sample and run through the
// surface effects.
//@ use common/shade
//@ use glue/surface

// Linear RGBA of a pixel, given its triangle id.
fn shading_color(id: u32, pixel: vec2u) -> vec4f {
    shade_begin(id);
    return glue_surface(shade_surface(pixel)).color;
}
