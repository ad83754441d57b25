// Shading, heat: a pixel shows how many layers it has.
//@ use common/frame
//@ use common/color
//@ use common/surface
//@ use glue/surface

@group(0) @binding(15) var<storage, read> layers: array<u32>;

fn shading_color(id: u32, pixel: vec2u) -> vec4f {
    let heat = overdraw_heat(layers[pixel.y * frame.size.x + pixel.x], effects.overdraw);
    return vec4f(color_decode(overdraw_color(heat, effects.overdraw)), 1.0);
}
