// Shading: the color that the resolve pass shows for a pixel.
// Chosen by effects that show all layers. Default: nearest.
//
// Linear RGBA of a pixel, given the id of its nearest triangle.
//@ declare fn shading_color(id: u32, pixel: vec2u) -> vec4f

//@ variant nearest
// The surface of the nearest triangle, after the surface effects.
//@ use lib/shade
//@ use glue/surface

fn shading_color(id: u32, pixel: vec2u) -> vec4f {
    shade_begin(id);
    return glue_surface(shade_surface(pixel), shaded.draw).color;
}

//@ variant overdraw
// The number of layers as heat.
//@ use lib/frame
//@ use lib/color
//@ use effects/overdraw
//@ use glue/effects

@group(0) @binding(15) var<storage, read> layers: array<u32>;

fn shading_color(id: u32, pixel: vec2u) -> vec4f {
    let heat = overdraw_heat(layers[pixel.y * frame.size.x + pixel.x], effects.overdraw);
    return vec4f(color_decode(overdraw_color(heat, effects.overdraw)), 1.0);
}

//@ variant xray
// The average of all layers. A pixel whose sums have overflowed shows a check of magenta and black.
//@ use lib/frame
//@ use lib/color
//@ use lib/picture
//@ use lib/xray_sums
//@ use effects/xray
//@ use glue/effects
//@ use variants/framebuffer_read

fn shading_color(id: u32, pixel: vec2u) -> vec4f {
    let first = SUM_WORDS * (pixel.y * frame.size.x + pixel.x);
    var words: vec4u;
    for (var i = 0u; i < SUM_WORDS; i += 1u) { words[i] = framebuffer_load_behind(first + i); }
    let behind = vec4f(color_decode(background.rgb), background.a);
    let mark = vec4f(vec3f(1.0, 0.0, 1.0) * f32(((pixel.x ^ pixel.y) >> 1u) & 1u), 1.0);
    let seen = xray_over(xray_sums_color(words), behind, xray_sums_weight(words), effects.xray);
    return select(seen, mark, xray_sums_is_full(words));
}

//@ variant glass
// The nearest opaque triangle or the background, seen through the layers of glass before it. The nearest triangle of such a pixel is
// the first of these.
//@ use lib/frame
//@ use lib/color
//@ use lib/picture
//@ use lib/shade
//@ use lib/glass
//@ use lib/glass_composed
//@ use glue/surface
//@ use variants/framebuffer_read

fn shading_color(id: u32, pixel: vec2u) -> vec4f {
    let index = pixel.y * frame.size.x + pixel.x;
    let opaque = framebuffer_load_behind(glass_opaque(index));
    let is_seen_through = opaque != ~id;
    shade_begin(select(0u, ~opaque, opaque != 0u));
    let surface = glue_surface(shade_surface(pixel), shaded.draw);
    let behind = select(vec4f(color_decode(background.rgb), background.a), surface.color, opaque != 0u);
    if !is_seen_through { return behind; }
    let layer = glass_composed_load(index);
    let passed = dot(layer.passed, vec3f(1.0 / 3.0));
    return vec4f(behind.rgb * layer.passed + layer.added, 1.0 + (behind.a - 1.0) * passed);
}
