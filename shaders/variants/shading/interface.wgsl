// Shading: the color that the resolve pass shows for a pixel.
// Chosen by effects that show all layers. Default: nearest.
//
// Linear RGBA of a pixel, given the id of its nearest triangle.
//@ declare fn shading_color(id: u32, pixel: vec2u) -> vec4f
