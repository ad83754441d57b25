// Image stores: where an image pass puts the color of a pixel.
// Chosen by the place of the pass in the frame: the last one writes the picture. Default: between.
//
// `width` is that of what the pass writes, pixels.
//@ declare fn image_store(at: vec2u, width: u32, color: vec4f)

//@ variant between
// In linear light, for the next pass.
@group(0) @binding(35) var<storage, read_write> image_target: array<vec4f>;

fn image_store(at: vec2u, width: u32, color: vec4f) {
    image_target[at.y * width + at.x] = color;
}

//@ variant finished
// As gamma-encoded bytes of the picture.
//@ use lib/frame
//@ use lib/color

@group(0) @binding(36) var<storage, read_write> finished: array<u32>;

fn image_store(at: vec2u, width: u32, color: vec4f) {
    finished[at.y * frame.stride + at.x] = color_pack(vec4f(color_encode(color.rgb), color.a));
}
