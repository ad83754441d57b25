// Finish, image: the image effects of the stack, one after the other. Triangle ids and depth keys of all pixels are final by now.
//@ use common/image
//@ use glue/image

fn finish(pixel: vec2u, encoded: vec4f) -> vec4f {
    return glue_image(Pixel(clamp(encoded, vec4f(0.0), vec4f(1.0)), pixel.x, pixel.y)).color;
}
