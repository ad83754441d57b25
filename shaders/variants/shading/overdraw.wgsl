// Shading, overdraw: the number of layers as heat.
//@ use lib/frame
//@ use lib/color
//@ use effects/overdraw
//@ use glue/effects

@group(0) @binding(15) var<storage, read> layers: array<u32>;

fn shading_color(id: u32, pixel: vec2u) -> vec4f {
    let heat = overdraw_heat(layers[pixel.y * frame.size.x + pixel.x], effects.overdraw);
    return vec4f(color_decode(overdraw_color(heat, effects.overdraw)), 1.0);
}
